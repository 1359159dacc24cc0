"""Whether a fuzzy law does better than clipped optimal control, as the review says of its [129]:
peak displacement and peak acceleration. It prints neither law nor numbers.

Both laws get the same plant, observer, sensors and current limit, and as many trials of the same
search on the same earthquakes, for the same cost; both are judged on other earthquakes.
"""

import tempfile
from collections.abc import Callable, Sequence
from contextlib import closing
from pathlib import Path
from typing import Any

import numpy as np
from quiesce.base.pools import Processes
from quiesce.base.runner import mapped
from quiesce.base.searches.methods import METHODS
from quiesce.base.table import format_table

from quiesce_benchmarks.papers import frame_laws
from quiesce_benchmarks.papers.frame_laws import MAX_A, Frame, Law, Response, shaken
from quiesce_benchmarks.part import Effort, Measured
from quiesce_benchmarks.seeds import generator

TITLE = "fuzzy beside clipped optimal control: tuned alike, judged on other earthquakes"
FIGURES = (
    ("fuzzy_over_clipped", "-", None, "lower"),
    ("fuzzy_over_clipped_spread", "-", None, "lower"),
)
FUZZY, CLIPPED = "fuzzy", "clipped"
# What makes each law, and the ranges of what is tuned.
LAWS: dict[str, tuple[Callable[..., Law], np.ndarray]] = {
    CLIPPED: (frame_laws.clipped_optimal, np.array([[2.0, 6.0], [-4.0, 0.0], [-6.0, 0.0]])),
    FUZZY: (
        frame_laws.fuzzy,
        np.array([[-2.5, -0.3], [-2.0, 0.0], [0.2, 1.0], [0.0, 1.0], [0.0, 1.0]]),
    ),
}
POPULATION = 8
MEASURES = ("peak_drift_m", "peak_accel_m_s2")


def responses(of: Frame, law: Law, seed: int, names: Sequence[tuple[Any, ...]]) -> list[Response]:
    return [
        shaken(of, law, frame_laws.earthquake(generator(seed, *name)), generator(seed, "n", *name))
        for name in names
    ]


def relative(found: list[Response], off: list[Response]) -> np.ndarray:
    """[earthquakes, MEASURES]: peaks over those without current."""
    return np.array(
        [
            [getattr(one, key) / getattr(without, key) for key in MEASURES]
            for one, without in zip(found, off, strict=True)
        ]
    )


def no_current(_state: np.ndarray, _force_N: float) -> float:
    return 0.0


def tuned(
    of: Frame, name: str, seed: int, repeat: int, quakes: int, trials: int
) -> tuple[np.ndarray, float]:
    """Values of the law's parameters with the least mean of both peaks, and that mean."""
    make, ranges = LAWS[name]
    low, span = ranges[:, 0], np.ptp(ranges, axis=1)
    names = [("tuning", repeat, k) for k in range(quakes)]
    off = responses(of, no_current, seed, names)
    rng = generator(seed, "search", name, repeat)
    search = METHODS["bees"](rng.random((POPULATION, len(ranges))), rng)
    points, best, count = next(search), (np.inf, low), 0
    while count < trials:
        costs = []
        for point in points:
            values = low + span * point
            law = make(of, *values)
            costs.append(float(np.mean(relative(responses(of, law, seed, names), off))))
            best = min(best, (costs[-1], values), key=lambda one: one[0])
        count += len(points)
        points = search.send(np.array(costs))
    return best[1], best[0]


def trial(work: tuple[str, int, int, int, int, int]) -> dict[str, Any]:
    """One law of one repeat: tuned on some earthquakes, judged on others."""
    name, seed, repeat, quakes, trials, judged = work
    with tempfile.TemporaryDirectory() as folder:
        of = frame_laws.frame(Path(folder))
        values, cost = tuned(of, name, seed, repeat, quakes, trials)
        names = [("judging", repeat, k) for k in range(judged)]
        found = responses(of, LAWS[name][0](of, *values), seed, names)
        peaks = relative(found, responses(of, no_current, seed, names))
    return {
        "law": name,
        "repeat": repeat,
        "values": values.tolist(),
        "tuned_cost": cost,
        "peaks": peaks.tolist(),
        "mean_current_part": float(np.mean([one.mean_A for one in found]) / MAX_A),
    }


def table(by_law: dict[str, list[dict[str, Any]]]) -> str:
    head = ["law", "repeat", "tuned at", "peak drift", "peak accel.", "mean current"]
    rows = [
        [
            one["law"],
            str(one["repeat"]),
            f"{one['tuned_cost']:.3f}",
            *(f"{value:.3f}" for value in np.mean(one["peaks"], axis=0)),
            f"{one['mean_current_part']:.2f}",
        ]
        for name in LAWS
        for one in by_law[name]
    ]
    return format_table(head, rows, left=(0,))


def measure(effort: Effort) -> Measured:
    repeats, quakes, trials, judged = (2, 1, 8, 2) if effort.is_quick else (4, 3, 48, 6)
    works = [
        (name, effort.seed, repeat, quakes, trials, judged)
        for repeat in range(repeats)
        for name in LAWS
    ]
    with closing(Processes(2)) as pool:
        found = mapped(pool, trial, works)
    by_law = {name: [one for one in found if one["law"] == name] for name in LAWS}
    peaks = {name: np.concatenate([one["peaks"] for one in by_law[name]]) for name in LAWS}
    ratios = peaks[FUZZY] / peaks[CLIPPED]
    value = float(np.mean(ratios))
    spread = float(np.std(np.mean(ratios, axis=1), ddof=1))
    reported = {
        "ratio": value,
        "spread": spread,
        "drift_ratio": float(np.mean(ratios[:, 0])),
        "accel_ratio": float(np.mean(ratios[:, 1])),
        "fuzzy_better_pct": 100.0 * float(np.mean(np.mean(ratios, axis=1) < 1.0)),
        "earthquakes": len(ratios),
        "trials_a_law": trials,
        "laws": found,
    }
    figures = {"fuzzy_over_clipped": value, "fuzzy_over_clipped_spread": spread}
    return Measured(figures, reported, (table(by_law),))
