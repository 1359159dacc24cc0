"""How many evaluations and how much time a 7-parameter Bouc-Wen fit takes, against scipy's
differential evolution at its defaults.

Truths: a normalised Bouc-Wen over the motion of damper_speed (2000 samples at 500 Hz), parameters
even in speed.LOW .. HIGH, 1 % white noise on the force. Both search the same bounds, the
search ranges of the library. Ours counts every simulated candidate: starts, derivatives,
projections. scipy searches all 7 parameters, and is given the leanest evaluation there is of one
candidate: the library's scalar set, one step a sample (enough for 1e-4, see speed), without
any Python around it but the call. Times are the thread's own processor time.
"""

import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from quiesce.base.progress import Progress
from quiesce.base.table import format_table
from quiesce.damper import library
from quiesce.damper.data.record import Record
from quiesce.damper.data.split import whole
from quiesce.damper.fit.problem import Problem
from quiesce.damper.fit.setting import Setting
from quiesce.damper.fit.small import fit_small
from quiesce.damper.library import RIG, Scales
from scipy.optimize import differential_evolution

from quiesce_benchmarks.damper import speed
from quiesce_benchmarks.damper.synthetic import FINER, finest_steps, force_of, with_force
from quiesce_benchmarks.report import Figure

NOISE_PART = 0.01
AT_FLOOR = 1.02  # of the noise floor: reached
SUCCESS_GOAL_pct = 95.0
EVALS_GOAL = 100.0
TIME_GOAL = 40.0
# What a diverged candidate costs: more than any force.
_DIVERGED = 1e30


@dataclass(frozen=True)
class Size:
    truths: int
    compared: int  # of them also by scipy


FULL = Size(100, 100)
QUICK = Size(20, 3)


@dataclass(frozen=True)
class Outcome:
    """A fit: error over the noise floor, simulated candidates, processor time."""

    over_floor: float
    evaluations: int
    seconds: float

    @property
    def is_success(self) -> bool:
        return self.over_floor <= AT_FLOOR


@dataclass(frozen=True)
class Case:
    """One truth."""

    ours: Outcome
    scipy: Outcome | None


def truth_record(seed: int) -> tuple[Record, float]:
    """A test with noise, and the relative error that the noise alone makes."""
    one = library.model(speed.MODEL)
    record = speed.test_record()
    row = speed.random_rows(1, 1000 + seed)[0]
    force_N = force_of(one, row, record, finest_steps(one, row, record, FINER))
    noisy = with_force(record, force_N, NOISE_PART, seed)
    floor = np.linalg.norm(noisy.force_N - force_N) / np.linalg.norm(noisy.force_N)
    return noisy, float(floor)


def problem_of(record: Record) -> Problem:
    """All 7 parameters within their search ranges."""
    one = library.model(speed.MODEL)
    scales = Scales.of([whole(record)])
    bounds = {parameter.name: parameter.search_range(scales) for parameter in one.parameters}
    return Problem(Setting(one, (0.0,), bounds=bounds), [whole(record)])


def our_fit(record: Record, floor: float, seed: int) -> Outcome:
    start_s = time.thread_time()
    problem = problem_of(record)
    found = fit_small(problem, seed)
    seconds = time.thread_time() - start_s
    evaluations = found.evaluations
    return Outcome(problem.error(found.values) / floor, evaluations, seconds)


def scipy_fit(record: Record, floor: float, seed: int) -> Outcome:
    problem = problem_of(record)
    one, motion = problem.model, library.motion(record)
    ones = np.ones(len(record))
    rest = np.zeros(len(RIG))

    def cost(values: np.ndarray) -> float:
        row = np.concatenate([values, rest])
        found = library.squared_error(
            one, speed.ORDERS, row, motion, 1, record.force_N, ones, 1, "scalar"
        )
        return float(found[0]) if np.isfinite(found[0]) else _DIVERGED

    bounds = [variable.bounds for variable in problem.variables]
    start_s = time.thread_time()
    found = differential_evolution(cost, bounds, rng=seed)
    seconds = time.thread_time() - start_s
    return Outcome(problem.error(found.x) / floor, int(found.nfev), seconds)


def measure(size: Size, progress: Progress | None = None) -> list[Case]:
    cases = []
    for seed in range(size.truths):
        record, floor = truth_record(seed)
        ours = our_fit(record, floor, seed)
        scipy = scipy_fit(record, floor, seed) if seed < size.compared else None
        cases.append(Case(ours, scipy))
        if progress is not None:
            progress.done(f"7-parameter Bouc-Wen, truth {seed + 1}")
    return cases


def ratios(cases: Sequence[Case]) -> tuple[list[float], list[float]]:
    """Evaluations and time of scipy over ours, of the cases that both have."""
    both = [(one.scipy, one.ours) for one in cases if one.scipy is not None]
    evaluations = [scipy.evaluations / ours.evaluations for scipy, ours in both]
    seconds = [scipy.seconds / ours.seconds for scipy, ours in both]
    return evaluations, seconds


def figures_of(cases: Sequence[Case]) -> list[Figure]:
    success_pct = 100.0 * float(np.mean([one.ours.is_success for one in cases]))
    scipy = [one.scipy.is_success for one in cases if one.scipy is not None]
    evaluations, seconds = ratios(cases)
    return [
        Figure("bw7_success_pct", success_pct, "%", SUCCESS_GOAL_pct, "higher"),
        Figure("bw7_evals_ratio", float(np.median(evaluations)), "1", EVALS_GOAL, "higher"),
        Figure("bw7_time_ratio", float(np.median(seconds)), "1", TIME_GOAL, "higher"),
        Figure("bw7_scipy_success_pct", 100.0 * float(np.mean(scipy)), "%", None, "higher"),
        Figure(
            "bw7_evaluations",
            float(np.median([one.ours.evaluations for one in cases])),
            "1",
            None,
            "lower",
        ),
    ]


def table(cases: Sequence[Case]) -> str:
    both = [one for one in cases if one.scipy is not None]
    groups = [
        (f"ours, all {len(cases)} truths", [one.ours for one in cases]),
        (f"ours, the first {len(both)}", [one.ours for one in both]),
        (f"scipy DE, the first {len(both)}", [one.scipy for one in both if one.scipy]),
    ]
    rows = [
        [
            name,
            f"{100.0 * np.mean([one.is_success for one in some]):.0f}",
            f"{max(one.over_floor for one in some):.4f}",
            f"{np.median([one.evaluations for one in some]):.0f}",
            f"{max(one.evaluations for one in some)}",
            f"{1e3 * np.median([one.seconds for one in some]):.1f}",
        ]
        for name, some in groups
    ]
    head = ["", "at the noise floor, %", "worst / floor", "evaluations", "most", "ms"]
    text = "7-parameter Bouc-Wen, 2000 samples, 1 % noise; medians; processor time of one thread"
    return f"{text}\n{format_table(head, rows)}"


def figures(quick: bool, folder: Path) -> tuple[list[Figure], list[str]]:
    """Figures and tables. Nothing is written into the folder."""
    del folder
    size = QUICK if quick else FULL
    cases = measure(size, Progress(size.truths))
    return figures_of(cases), [table(cases)]
