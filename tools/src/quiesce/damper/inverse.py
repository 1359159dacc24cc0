"""The current for a wanted force at a given motion: what a control law needs of a damper model.

A semi-active damper only resists: of a wanted force what it can give is between its forces at 0 and
at the largest current, of the sign that it has. Beyond, the current saturates: at the largest where
more force of the right sign is wanted, at 0 where less, or one of the other sign, is.

Two ways: InverseByInterpolation takes any model: it runs one copy of it at each of several constant
currents along the motion, each with its own hysteretic state, and interpolates. ClosedForm is for
static models whose force is a polynomial of 2nd order in the current, and solves it. Neither looks
ahead to the coil's lag. Source: Bouc-Wen inverse by interpolation as corrected in the project's
reference of models: magnitudes are compared, the sign is checked.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from quiesce.base.errors import UsageError
from quiesce.damper import library
from quiesce.damper.command_range import command_unit
from quiesce.damper.data.record import Record
from quiesce.damper.model_file import DamperModel
from quiesce.damper.score import Simulate

# Currents of the grid, and periods after which a hysteretic loop is taken as closed.
GRID = 21
_CYCLES = 3
_SAMPLES_A_CYCLE = 400
_FINE = 201  # currents of the check; fewer for models that have to be integrated
_COARSE = 31
# A step down by this part of the range of forces is not noise of the integration.
_FALLING = 1e-6
VOLTAGE = "its command is a voltage; an inverse gives a current in A"

Forces = Callable[[Record, np.ndarray], np.ndarray]


def forces_at(damper: DamperModel, record: Record, currents_A: Sequence[float]) -> np.ndarray:
    """Forces in N of a kernel at constant coil currents along a record's motion, [currents,
    samples]; without rig and lag. Each has its own state."""
    one, orders, row = damper.kernel_row()
    bare = row.copy()
    first = len(row) - len(library.RIG)
    for name in library.RIG[:6]:
        bare[first + library.RIG.index(name)] = 0.0
    currents = np.atleast_1d(np.asarray(currents_A, dtype=float))
    steps = 1
    if one.states:
        rates = [library.fastest_rates(one, orders, bare, at(record, i))[0] for i in currents]
        steps = library.substeps_for(max(rates), record.rate_Hz)
    if not (damper.rig.get("field_exponent") or _has_current_inside(one)):
        # At a constant current every parameter is a constant: all currents run side by side.
        rig = bare[first:]
        rows = [np.concatenate([library.values_at(one, orders, bare, i), rig]) for i in currents]
        motion = library.motion(record)
        return library.simulate(one, [1] * len(orders), np.array(rows), motion, steps)
    motions = [library.motion(at(record, i)) for i in currents]
    return np.concatenate([library.simulate(one, orders, bare, m, steps) for m in motions])


def _has_current_inside(one: library.Model) -> bool:
    """Whether its equations themselves work with the current, and no parameter follows it."""
    return not any(parameter.follows_current for parameter in one.parameters)


def at(record: Record, current_A: float) -> Record:
    return replace(record, command=np.full(len(record), float(current_A)), command_unit="A")


def forces_by(damper: DamperModel, simulate: Simulate | None) -> Forces:
    """Forces along a record at constant currents; `simulate` for models that are no kernels."""
    if damper.is_kernel:
        return lambda record, currents_A: forces_at(damper, record, currents_A)
    if simulate is None:
        raise UsageError(f"model {damper.model} needs its damper file to be simulated")
    return lambda record, currents_A: np.stack([simulate(at(record, i)) for i in currents_A])


class InverseByInterpolation:
    """Currents within 0 .. max_current_A, in A. UsageError where that is not > 0."""

    def __init__(
        self,
        damper: DamperModel,
        max_current_A: float,
        count: int = GRID,
        simulate: Simulate | None = None,
    ) -> None:
        check_current(max_current_A)
        self.currents_A = np.linspace(0.0, max_current_A, max(2, count))
        self._forces = forces_by(damper, simulate)

    def currents(self, record: Record, wanted_N: np.ndarray) -> np.ndarray:
        """Current in A at every sample for the wanted force in N, [samples]. The force at a sample
        depends on the motion up to it only, so this is what a law would have done on-line."""
        return interpolated(self.currents_A, self._forces(record, self.currents_A), wanted_N)


def interpolated(currents_A: np.ndarray, forces_N: np.ndarray, wanted_N: np.ndarray) -> np.ndarray:
    """The least current whose force, between those of a grid [currents, samples], is the wanted one
    [samples]; 0 or the last where none is."""
    side = np.where(wanted_N < 0.0, -1.0, 1.0)
    ahead = side * forces_N - np.abs(wanted_N)  # above 0: too much of the right sign
    below, above = ahead[:-1] < 0.0, ahead[1:] >= 0.0
    crosses = below & above
    first = np.argmax(crosses, axis=0)
    columns = np.arange(forces_N.shape[1])
    low, high = ahead[first, columns], ahead[first + 1, columns]
    rise = np.where(high > low, high - low, 1.0)
    part = np.clip(-low / rise, 0.0, 1.0)
    step = currents_A[first + 1] - currents_A[first]
    crossing = currents_A[first] + part * step
    is_short = ahead.max(axis=0) < 0.0
    # Most of the right sign, where there is any; else the least force.
    most = currents_A[np.argmax(ahead, axis=0)]
    right_sign = (side * forces_N).max(axis=0) > 0.0
    saturated = np.where(is_short & right_sign, most, 0.0)
    return np.where(crosses.any(axis=0) & (ahead[0] < 0.0), crossing, saturated)


class ClosedForm:
    """For static models whose force is f0 + f1 i + f2 i^2 in the current at any motion: those whose
    nonlinear parameters do not follow it (Bingham, tanh models with a constant shape, polynomials).
    UsageError for others. Evaluates single instants, so that it serves on-line as well."""

    def __init__(self, damper: DamperModel, max_current_A: float) -> None:
        check_current(max_current_A)
        if why := why_no_closed_form(damper):
            raise UsageError(f"{damper.name}: no closed form, {why}; interpolate instead")
        self.damper = damper
        self.max_current_A = max_current_A

    def currents(self, record: Record, wanted_N: np.ndarray) -> np.ndarray:
        """Current in A for the wanted force in N at every sample."""
        i = self.max_current_A
        grid = np.array([0.0, 0.5 * i, i])
        forces = forces_at(self.damper, record, grid)
        side = np.where(wanted_N < 0.0, -1.0, 1.0)
        f0, middle, full = side * forces
        f2 = 2.0 * (full - 2.0 * middle + f0) / i**2
        f1 = (full - f0) / i - f2 * i
        # The force rises up to here.
        with np.errstate(divide="ignore", invalid="ignore"):
            peak = np.where(f2 < 0.0, np.clip(-f1 / (2.0 * f2), 0.0, i), i)
        peak = np.where((f1 <= 0.0) & (f2 <= 0.0), 0.0, peak)
        most = f0 + peak * (f1 + peak * f2)
        wanted = np.abs(wanted_N)
        root = smaller_root(f2, f1, f0 - wanted)
        inside = (wanted > f0) & (wanted <= most)
        short = (wanted > most) & (most > 0.0)
        return np.where(inside, np.clip(root, 0.0, peak), np.where(short, peak, 0.0))

    def current(
        self, disp_m: float, velocity_m_s: float, accel_m_s2: float, wanted_N: float
    ) -> float:
        """Current in A at one instant."""
        two = [np.full(2, value) for value in (disp_m, velocity_m_s, accel_m_s2)]
        zero = np.zeros(2)
        record = Record("instant", 1000.0, np.arange(2) / 1000.0, *two, zero, zero, "A")
        return float(self.currents(record, np.full(2, wanted_N))[0])


def smaller_root(a: np.ndarray, b: np.ndarray, c: np.ndarray) -> np.ndarray:
    """Where a x^2 + b x + c first rises through 0, for c <= 0; in the form that loses no digits."""
    spread = np.sqrt(np.maximum(b * b - 4.0 * a * c, 0.0))
    bottom = b + spread
    return np.where(bottom > 0.0, -2.0 * c / np.where(bottom > 0.0, bottom, 1.0), 0.0)


def why_no_closed_form(damper: DamperModel) -> str:
    """Empty where there is one."""
    if not damper.is_kernel:
        return "the model is not one of equations"
    one, orders, _ = damper.kernel_row()
    if one.states:
        return "the model remembers"
    if damper.rig.get("field_exponent"):
        return "the field saturates"
    if _has_current_inside(one):
        return "its equations have the current in them"
    following = [
        parameter.name
        for parameter, order in zip(one.parameters, orders, strict=True)
        if order > 1 and not parameter.is_linear
    ]
    return f"{following[0]} follows the current" if following else ""


def check_current(max_current_A: float) -> None:
    if not 0.0 < max_current_A < float("inf"):
        raise UsageError(f"largest current {max_current_A:g} A: it has to be above 0")


def check_amperes(damper: DamperModel) -> None:
    """UsageError for a file that is valid up to a voltage and to no current."""
    if command_unit(damper) != "A":
        raise UsageError(f"{damper.name}: {VOLTAGE}")


def check_finite(damper: DamperModel, force_N: np.ndarray) -> None:
    """UsageError where a force, of any shape, is infinite or no number."""
    if not np.isfinite(force_N).all():
        raise UsageError(f"{damper.name}: its force is not finite; a lower --max-speed-m-s may do")


# Monotonicity


@dataclass(frozen=True)
class Axis:
    """What a damper's force has the sign of, and goes over in a map."""

    name: str
    unit: str  # SI
    word: int  # quiesce_sense_t
    fine_unit: str  # the firmware's
    per_unit: float


VELOCITY = Axis("velocity", "m/s", 4, "um/s", 1e6)
STROKE = Axis("stroke", "m", 3, "nm", 1e9)  # of springs that the current stiffens
AXES = {axis.name: axis for axis in (VELOCITY, STROKE)}


@dataclass(frozen=True)
class SteadyForces:
    """Forces of a loop that has closed: [places, currents] in N, in the direction of the place on
    the axis (> 0 resists): over velocity in mid-stroke, over stroke where the motion turns."""

    places: np.ndarray  # in the axis' unit
    currents_A: np.ndarray
    force_N: np.ndarray
    axis: Axis = VELOCITY


def steady_forces(
    damper: DamperModel,
    places: Sequence[float],
    currents_A: Sequence[float],
    amplitude_m: float | None = None,
    simulate: Simulate | None = None,
    axis: Axis = VELOCITY,
) -> SteadyForces:
    """Over velocity: from sines of `amplitude_m` (half the stroke unless given) whose largest speed
    is the velocity; a negative one is met on the way back. Over stroke: from sines of 1 Hz that
    turn there."""
    amplitude = amplitude_m or 0.5 * damper.stroke_m
    forces = forces_by(damper, simulate)
    currents = np.asarray(currents_A, dtype=float)
    rows = []
    for one in places:
        if axis == VELOCITY:
            record, row = sine_at(abs(one), amplitude, one < 0.0)
        else:
            record, row = sine_turning_at(abs(one), one < 0.0)
        rows.append(np.sign(one) * forces(record, currents)[:, row])
    return SteadyForces(np.asarray(places, dtype=float), currents, np.array(rows), axis)


def sine_at(speed_m_s: float, amplitude_m: float, is_back: bool) -> tuple[Record, int]:
    """A sine that passes mid-stroke at this speed, and the row of its last such passage."""
    freq_Hz = speed_m_s / (2.0 * np.pi * amplitude_m)
    rate_Hz = _SAMPLES_A_CYCLE * freq_Hz
    time_s = np.arange(_CYCLES * _SAMPLES_A_CYCLE + 1) / rate_Hz
    place = len(time_s) - 1 - (_SAMPLES_A_CYCLE // 2 if is_back else 0)
    w, zero = 2.0 * np.pi * freq_Hz, np.zeros(len(time_s))
    disp_m = amplitude_m * np.sin(w * time_s)
    disp_m[place] = 0.0  # models look at its sign
    record = Record(
        "sine", rate_Hz, time_s, disp_m,
        amplitude_m * w * np.cos(w * time_s), -amplitude_m * w**2 * np.sin(w * time_s),
        zero, zero, "A",
    )  # fmt: skip
    return record, place


def sine_turning_at(stroke_m: float, is_below: bool) -> tuple[Record, int]:
    """A sine of 1 Hz and this amplitude, and the row of its last turn on the wanted side."""
    rate_Hz = float(_SAMPLES_A_CYCLE)
    turn = 2.0 * np.pi * np.arange(_CYCLES * _SAMPLES_A_CYCLE + 1) / rate_Hz
    row = len(turn) - 1 - _SAMPLES_A_CYCLE * (1 if is_below else 3) // 4
    w, zero = 2.0 * np.pi, np.zeros(len(turn))
    velocity_m_s = stroke_m * w * np.cos(turn)
    velocity_m_s[row] = 0.0
    record = Record(
        "sine", rate_Hz, turn / w, stroke_m * np.sin(turn), velocity_m_s,
        -stroke_m * w**2 * np.sin(turn), zero, zero, "A",
    )  # fmt: skip
    return record, row


@dataclass(frozen=True)
class Monotone:
    """Up to which current the force rises with it: everywhere, and at each place of the axis."""

    limit_A: float
    per_place_A: np.ndarray
    forces: SteadyForces

    @property
    def is_whole(self) -> bool:
        return self.limit_A >= self.forces.currents_A[-1]


def monotone_range(
    damper: DamperModel,
    max_current_A: float,
    places: Sequence[float] | None = None,
    simulate: Simulate | None = None,
    axis: Axis = VELOCITY,
) -> Monotone:
    """Places: 3 % to all of the model's speed, or stroke, both ways, unless given. Beyond limit_A
    two currents give one force, so that the inverse ends there. UsageError where a force is not
    finite."""
    check_current(max_current_A)
    if places is None:
        places = default_places(damper, axis)
    is_static = damper.is_kernel and damper.kernel_row()[0].states == 0
    currents = np.linspace(0.0, max_current_A, _FINE if is_static else _COARSE)
    found = steady_forces(damper, places, currents, simulate=simulate, axis=axis)
    check_finite(damper, found.force_N)
    limits = np.array([rising_until(currents, row) for row in found.force_N])
    return Monotone(float(limits.min()), limits, found)


def default_places(damper: DamperModel, axis: Axis = VELOCITY) -> np.ndarray:
    """UsageError where the file does not say how far or how fast it moves."""
    if not (damper.speed_m_s > 0.0 or axis == STROKE) or not damper.stroke_m > 0.0:
        raise UsageError(
            f"{damper.name}: the file states no stroke or no speed; --amplitude-mm and "
            "--max-speed-m-s do"
        )
    largest = damper.speed_m_s if axis == VELOCITY else damper.stroke_m
    places = largest * np.array([0.03, 0.1, 0.3, 1.0])
    return np.concatenate([-places[::-1], places])


def rising_until(currents_A: np.ndarray, force_N: np.ndarray) -> float:
    """The current of the first peak, by a parabola through its neighbours; the last current where
    the force rises throughout."""
    steps = np.diff(force_N)
    falls = np.flatnonzero(steps < -_FALLING * max(float(np.ptp(force_N)), 1e-300))
    if not falls.size:
        return float(currents_A[-1])
    k = int(falls[0])
    if k == 0:
        return float(currents_A[0])
    before, here, after = force_N[k - 1], force_N[k], force_N[k + 1]
    bend = before - 2.0 * here + after
    part = 0.5 * (before - after) / bend if bend < 0.0 else 0.0
    return float(currents_A[k] + np.clip(part, -1.0, 1.0) * (currents_A[1] - currents_A[0]))


def inverse_map(
    found: SteadyForces, forces_N: Sequence[float]
) -> tuple[np.ndarray, np.ndarray]:  # fmt: skip
    """Currents in A for forces in N (in the direction of the motion) at each place, [places,
    forces], and whether each is feasible. Monotone rows only: cut currents at the limit first."""
    wanted = np.asarray(forces_N, dtype=float)
    currents = np.stack(
        [
            interpolated(found.currents_A, np.repeat(row[:, None], len(wanted), axis=1), wanted)
            for row in found.force_N
        ]
    )
    low, high = found.force_N.min(axis=1), found.force_N.max(axis=1)
    feasible = (wanted >= low[:, None]) & (wanted <= high[:, None])
    return currents, feasible
