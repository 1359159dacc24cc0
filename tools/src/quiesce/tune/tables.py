"""Tables of pulses over frequency, smooth enough for linear interpolation between their points.

At each frequency several local optima are found. One each is chosen so that the sum of their costs
and of the differences between neighbours' currents over the phase is least (a shortest path), so
that a slightly better pulse of another kind does not break a table in two.
"""

from dataclasses import dataclass, replace

import numpy as np

from quiesce.optimum.goal import Goal, Reference, reference
from quiesce.optimum.periodic import Orbit, drive, solve
from quiesce.plant.library import Plant
from quiesce.tune.phase_table import Point, interpolated
from quiesce.tune.pulse import Pulse, best_pulse, command_of, tracked
from quiesce.tune.setting import Marks, Setting

# Of the displacement's phase: current ends soon after the peak (below resonance) or starts with it.
FIRST_CENTRES_DEG = (45.0, 110.0)
FIRST_WIDTHS_DEG = (100.0, 160.0)
FIRST_RAMP_DEG = 30.0
ROUGHNESS = 0.02  # cost of currents that differ by full scale throughout
CONSTANT_DEG = 179.5  # a wider pulse is a constant current
TRIM_DEG = 1.0
MOST_WEIGHT = 2.0
LONGEST_RAMP_DEG = 89.99


@dataclass(frozen=True)
class Candidate:
    """A local optimum, at a phase of the displacement."""

    pulse: Pulse
    cost: float
    amp_red_pct: float
    accel_red_pct: float
    mean_current_A: float
    accel_weight: float


@dataclass(frozen=True)
class TableCase:
    """One frequency of one setting; bound_pct: the reduction that its fractions are of."""

    plant: Plant
    setting: Setting
    freq_Hz: float
    bound_pct: float
    has_ramp: bool = True


def candidates(case: TableCase) -> list[Candidate]:
    """Local optima of the setting's goal that applies, best first."""
    ref = reference(drive(case.plant, case.freq_Hz))
    marks = _marks(ref, case)
    first = case.setting.first(marks)
    weight = case.setting.adapt_weight
    found = _search(ref, first, case.has_ramp, weight)
    if _keeps_limits(first, found[0]):
        return found
    return _search(ref, case.setting.second(marks), case.has_ramp, weight)


def _marks(ref: Reference, case: TableCase) -> Marks:
    constant = solve(ref.drive, case.plant.max_current_A)
    is_allowed = ref.accel_ratio(constant) <= case.setting.accel_limit
    return Marks(case.bound_pct, ref.amp_reduction_pct(constant) if is_allowed else 0.0)


def _keeps_limits(goal: Goal, candidate: Candidate) -> bool:
    slack = 1e-3
    return (
        1.0 - candidate.accel_red_pct / 100.0 <= goal.accel_limit + slack
        and 1.0 - candidate.amp_red_pct / 100.0 <= goal.amp_limit + slack
    )


def _search(ref: Reference, goal: Goal, has_ramp: bool, weight: float | None) -> list[Candidate]:
    full_A = ref.drive.plant.max_current_A
    lead_deg = ref.orbit.tracked_deg
    firsts = [Pulse(0.0, 180.0, full_A, 0.0), Pulse(0.0, 180.0, 0.5 * full_A, 0.0)]
    for centre_deg in FIRST_CENTRES_DEG:
        for width_deg in FIRST_WIDTHS_DEG:
            firsts.append(Pulse(centre_deg - lead_deg, width_deg, full_A, 0.0))
        if has_ramp:
            # From sharp edges none finds its way to ramps.
            width_deg = FIRST_WIDTHS_DEG[0]
            firsts.append(Pulse(centre_deg - lead_deg, width_deg, full_A, 0.0, FIRST_RAMP_DEG))
    found = [_candidate(ref, goal, first, has_ramp, weight) for first in firsts]
    return sorted(found, key=lambda candidate: candidate.cost)


def _candidate(
    ref: Reference, goal: Goal, first: Pulse, has_ramp: bool, weight: float | None
) -> Candidate:
    pulse, optimum = best_pulse(ref, goal, first, has_ramp)
    orbit = optimum.orbit
    return Candidate(
        pulse.moved(orbit.tracked_deg),
        optimum.cost,
        ref.amp_reduction_pct(orbit),
        ref.accel_reduction_pct(orbit),
        orbit.mean_current_A,
        accel_weight(ref, pulse) if weight is None else weight,
    )


def accel_weight(ref: Reference, pulse: Pulse) -> float:
    """w for which ln A + w ln a is stationary for small changes of the pulse's edges.

    A: amplitude, a: RMS acceleration. 0 where no w >= 0 comes close.
    """
    amp, accel = [], []
    for centre, width in ((TRIM_DEG, 0.0), (0.0, 2.0 * TRIM_DEG)):
        pair = [_trimmed(ref, pulse, sign * centre, sign * width) for sign in (1.0, -1.0)]
        amp.append(np.log(pair[0].amp_m / pair[1].amp_m))
        accel.append(np.log(pair[0].accel_rms_m_s2 / pair[1].accel_rms_m_s2))
    norm = float(np.dot(accel, accel))
    return min(max(0.0, -float(np.dot(amp, accel)) / norm), MOST_WEIGHT) if norm > 0.0 else 0.0


def _trimmed(ref: Reference, pulse: Pulse, centre_deg: float, width_deg: float) -> Orbit:
    width = min(max(pulse.width_deg + width_deg, 0.0), 180.0)
    moved = replace(pulse, centre_deg=pulse.centre_deg + centre_deg, width_deg=width)
    return solve(ref.drive, command_of(ref.drive, moved), start=ref.orbit.state)


def smoothest(found: list[list[Candidate]], full_A: float) -> list[Candidate]:
    """One candidate for each frequency: the shortest path through their costs and differences."""
    total = [c.cost for c in found[0]]
    back: list[list[int]] = []
    for before, after in zip(found, found[1:], strict=False):
        steps = [
            [
                total[i] + ROUGHNESS * difference(b.pulse, a.pulse, full_A)
                for i, b in enumerate(before)
            ]
            for a in after
        ]
        back.append([int(np.argmin(step)) for step in steps])
        total = [min(step) + a.cost for step, a in zip(steps, after, strict=True)]
    path = [int(np.argmin(total))]
    for came_from in reversed(back):
        path.append(came_from[path[-1]])
    return [each[i] for each, i in zip(found, reversed(path), strict=True)]


def difference(one: Pulse, other: Pulse, full_A: float) -> float:
    """Mean difference of two currents over the phase, in parts of full current."""
    phase_deg = np.arange(180.0)

    def current(pulse: Pulse) -> np.ndarray:
        away = np.abs((phase_deg - pulse.centre_deg + 90.0) % 180.0 - 90.0)
        return np.where(away <= 0.5 * pulse.width_deg, pulse.level_A, pulse.floor_A)

    return float(np.abs(current(one) - current(other)).mean() / full_A)


def filled(chosen: list[Candidate]) -> list[Candidate]:
    """Constant currents get centre, floor and weight between their nearest pulses': they are where
    the pulse on the way to the next point comes from."""
    is_pulse = np.array([c.pulse.width_deg < CONSTANT_DEG for c in chosen])
    if not is_pulse.any():
        return chosen
    at = np.arange(len(chosen))
    pulses = [c for c, is_one in zip(chosen, is_pulse, strict=True) if is_one]
    columns = [
        np.unwrap([c.pulse.centre_deg for c in pulses], period=180.0),
        [c.pulse.floor_A for c in pulses],
        [c.accel_weight for c in pulses],
    ]
    rows = zip(*(np.interp(at, at[is_pulse], column) for column in columns), strict=True)
    return [
        c if is_one else _constant(c, *map(float, row))
        for c, is_one, row in zip(chosen, is_pulse, rows, strict=True)
    ]


def _constant(chosen: Candidate, centre_deg: float, floor_A: float, weight: float) -> Candidate:
    level_A = chosen.pulse.level_A
    pulse = Pulse(centre_deg % 180.0, 180.0, level_A, min(floor_A, level_A))
    return replace(chosen, pulse=pulse, accel_weight=weight)


def table(freqs_Hz: list[float], found: list[list[Candidate]], full_A: float) -> list[Point]:
    """The points of a setting from the candidates at each frequency."""
    chosen = filled(smoothest(found, full_A))
    return [
        point(freq_Hz, candidate.pulse, candidate.accel_weight)
        for freq_Hz, candidate in zip(freqs_Hz, chosen, strict=True)
    ]


def point(freq_Hz: float, pulse: Pulse, weight: float) -> Point:
    level_mA, floor_mA = round(1e3 * pulse.level_A), round(1e3 * pulse.floor_A)
    width_deg = 180.0 if pulse.width_deg >= CONSTANT_DEG else round(pulse.width_deg, 2)
    centre_deg = round(pulse.centre_deg, 2) % 180.0
    return Point(
        freq_Hz, centre_deg, width_deg, level_mA, floor_mA, round(weight, 3),
        ramp_deg=min(round(pulse.ramp_deg, 2), LONGEST_RAMP_DEG),
    )  # fmt: skip


def pulse_of(point: Point) -> Pulse:
    ramp_deg = min(point.ramp_deg, point.width_deg, 180.0 - point.width_deg)
    return Pulse(
        point.centre_deg,
        point.width_deg,
        1e-3 * point.level_mA,
        1e-3 * point.floor_mA,
        max(ramp_deg, 0.0),
    )


def judged(plant: Plant, points: list[Point], freq_Hz: float) -> tuple[Reference, Orbit]:
    """What a table does at a frequency: the reference and the orbit."""
    ref = reference(drive(plant, freq_Hz))
    return ref, tracked(ref.drive, pulse_of(interpolated(points, freq_Hz)))
