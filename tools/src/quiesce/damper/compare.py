"""A damper model against new data: its errors, and what simple change would reduce them a lot."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from quiesce.damper.data.split import Segment
from quiesce.damper.model_file import DamperModel
from quiesce.damper.report.runs import Run, cycle_energies_J
from quiesce.damper.score import Score, score_segment

# A hint is worth giving where the error falls at least to this part of it.
TELLING = 0.8
# Largest shift in time that is tried, s.
MOST_SHIFT_S = 0.03


@dataclass(frozen=True)
class Hint:
    """A change that would reduce the error. It is never applied."""

    what: str
    value: float
    unit: str
    error: float  # with it
    text: str


@dataclass(frozen=True)
class Comparison:
    damper: DamperModel
    score: Score
    runs: list[Run]
    hints: list[Hint]
    warnings: list[str]

    @property
    def energy_ratios(self) -> list[float]:
        """Of each test: the energy that the model takes in over the measured one."""
        pairs = [cycle_energies_J(run) for run in self.runs]
        return [model / measured if measured else float("nan") for measured, model in pairs]


def compare(damper: DamperModel, runs: Sequence[Run]) -> Comparison:
    """runs: the model along the new tests."""
    score = Score(tuple(scored(run) for run in runs))
    segments = [run.segment for run in runs]
    return Comparison(
        damper, score, list(runs), hints_of(runs), warnings_of(damper, segments)
    )  # fmt: skip


def scored(run: Run):
    whole = np.full(len(run.segment.record), np.nan)
    whole[run.segment.rows] = run.model_N
    return score_segment(whole, run.segment)


# Hints


def hints_of(runs: Sequence[Run]) -> list[Hint]:
    """The changes that help, best first; none where the model diverges."""
    if not all(run.is_finite for run in runs):
        return []
    measured = np.concatenate([run.measured_N for run in runs])
    model = np.concatenate([run.model_N for run in runs])
    size = float(np.linalg.norm(measured))
    before = float(np.linalg.norm(measured - model)) / size
    makers: tuple[Callable[[], Hint], ...] = (
        lambda: sign_hint(measured, model, size),
        lambda: scale_hint(measured, model, size),
        lambda: offset_hint(measured, model, size),
        lambda: shift_hint(runs, size),
    )
    found = [make() for make in makers]
    telling = [one for one in found if one.error < TELLING * before]
    if any(one.what == "sign" for one in telling):
        telling = [one for one in telling if one.what != "scale"]
    return sorted(telling, key=lambda one: one.error)


def sign_hint(measured: np.ndarray, model: np.ndarray, size: float) -> Hint:
    error = float(np.linalg.norm(measured + model)) / size
    text = "the force looks turned: --flip-force, or the model is of the other sign"
    return Hint("sign", -1.0, "", error, text)


def scale_hint(measured: np.ndarray, model: np.ndarray, size: float) -> Hint:
    scale = float(measured @ model) / max(float(model @ model), 1e-300)
    error = float(np.linalg.norm(measured - scale * model)) / size
    text = (
        f"the model's force times {scale:.4g} fits better: another damper of this kind, another "
        "temperature, or a wrong unit (then the factor is one of units)"
    )
    return Hint("scale", scale, "-", error, text)


def offset_hint(measured: np.ndarray, model: np.ndarray, size: float) -> Hint:
    offset_N = float(np.mean(measured - model))
    error = float(np.linalg.norm(measured - model - offset_N)) / size
    text = f"{offset_N:+.4g} N more fits better: another gas pressure, preload or sensor zero"
    return Hint("offset", offset_N, "N", error, text)


def shift_hint(runs: Sequence[Run], size: float) -> Hint:
    """Best constant shift in time between force and motion, within MOST_SHIFT_S."""

    def squared(shift_s: float) -> float:
        return sum(float(np.sum((run.measured_N - shifted(run, shift_s)) ** 2)) for run in runs)

    grid = np.linspace(-MOST_SHIFT_S, MOST_SHIFT_S, 61)
    values = np.array([squared(shift_s) for shift_s in grid])
    k = int(np.clip(np.argmin(values), 1, len(grid) - 2))
    # Parabola through the best and its neighbours.
    bend = values[k - 1] - 2.0 * values[k] + values[k + 1]
    part = 0.5 * (values[k - 1] - values[k + 1]) / bend if bend > 0.0 else 0.0
    shift_s = float(grid[k] + np.clip(part, -1.0, 1.0) * (grid[1] - grid[0]))
    error = float(np.sqrt(squared(shift_s))) / size
    way = "later" if shift_s > 0.0 else "earlier"
    text = (
        f"the force {1e3 * abs(shift_s):.3g} ms {way} fits better: channels that are not sampled "
        "together, a filter on one of them, or another lag of the coil"
    )
    return Hint("skew", shift_s, "s", error, text)


def shifted(run: Run, shift_s: float) -> np.ndarray:
    """The model's force later by shift_s; its ends held."""
    places = np.arange(len(run.model_N))
    return np.interp(places - shift_s * run.rate_Hz, places, run.model_N)


# Where the model is known to hold


def warnings_of(damper: DamperModel, segments: Sequence[Segment]) -> list[str]:
    """What of the data lies outside of the range that the file states."""
    found = []
    if damper.valid.get("usable") is False:
        found.append(f"the file says: not usable. {damper.valid.get('reason', '')}".strip())
    speed = max(float(np.abs(one.record.velocity_m_s).max()) for one in segments)
    if 0.0 < 1.05 * damper.speed_m_s < speed:
        found.append(f"speeds up to {speed:.3g} m/s; the model is for {damper.speed_m_s:g} m/s")
    disp = max(float(np.abs(one.record.disp_m).max()) for one in segments)
    if 0.0 < 1.05 * damper.stroke_m < disp:
        found.append(f"travel up to {disp:.3g} m; the model's stroke is {damper.stroke_m:g} m")
    for key in ("current_A", "command_V"):
        limits = damper.valid.get(key)
        if not isinstance(limits, list) or not limits:
            continue
        room = 0.02 * abs(limits[-1]) + 0.02
        low, high = limits[0] - room, limits[-1] + room
        commands = np.concatenate([one.record.command for one in segments])
        if commands.min() < low or commands.max() > high:
            found.append(f"the command goes beyond {key} = {limits} of the file")
    return found
