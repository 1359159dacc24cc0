"""Dampers whose parameters are known, one of every kernel of the library, and tests of them.

Every truth is drawn at random from the middle of the model's search range (natural sizes: 1000 N,
and the stroke and speed of the tests), and drawn again where a value is too near zero for a
relative error, where the largest force is not of the order of 1000 N, where the search range for
the test's own sizes does not hold it, or where the tests do not determine it (Cramer-Rao; of
DRAWS that are otherwise fit, the best determined one then). Its force is integrated FINER times
finer than a fit does.
"""

from dataclasses import dataclass

import numpy as np
from quiesce.damper import library
from quiesce.damper.data.record import Record
from quiesce.damper.data.split import whole
from quiesce.damper.fit.intervals import standard_deviations
from quiesce.damper.fit.problem import Problem, make_variable
from quiesce.damper.fit.setting import Setting
from quiesce.damper.library import Model, Scales

from quiesce_benchmarks.damper.synthetic import (
    Tones,
    finest_steps,
    force_of,
    motion_record,
    record_of,
    row_of,
    with_force,
)

RATE_Hz = 400.0
SAMPLES = 1600  # of each test
FORCE_N = 1000.0
STROKE_m = 0.01
SPEED_m_s = 0.25
# Part of the search range that truths come from; the least value over the range's largest.
MIDDLE = (0.2, 0.8)
LEAST = 0.05
MOST_DRAWS = 400
DRAWS = 24
# Cramer-Rao standard deviation of every parameter over its value, at 1 % noise.
DETERMINED = 0.3
NOISE_PART = 0.01
# Substeps a sample that a truth may need, in the first and in later draws: soft ones are preferred.
MOST_SUBSTEPS = (6, 16)
FIRST_DRAWS = 200
_FORCES_N = (0.25 * FORCE_N, 4.0 * FORCE_N)


@dataclass(frozen=True)
class Truth:
    model: Model
    row: np.ndarray  # of the library, constant parameters
    records: list[Record]  # with the exact force

    def problem(self, noise_part: float = 0.0, seed: int = 0) -> Problem:
        """The fit of tests with this noise, over the RMS of all forces; every sample counts the
        same."""
        rms_N = float(np.sqrt(np.mean([np.mean(one.force_N**2) for one in self.records])))
        noisy = []
        for k, one in enumerate(self.records):
            own_N = float(np.sqrt(np.mean(one.force_N**2)))
            noisy.append(with_force(one, one.force_N, noise_part * rms_N / own_N, 100 * seed + k))
        return Problem(Setting(self.model, (0.0,)), [whole(one) for one in noisy], "sample")

    def values(self, problem: Problem) -> np.ndarray:
        """Of the problem's variables."""
        return np.array([self.row[one.slot] for one in problem.variables])

    def deviations(self, noise_part: float = NOISE_PART) -> np.ndarray:
        """Cramer-Rao standard deviations over the values, of the problem's variables, with noise of
        this part of the force's RMS; infinite for what the tests do not determine."""
        problem = self.problem()
        values = self.values(problem)
        jacobian = problem.jacobian(values, problem.difference_steps(values))
        variance = noise_part**2 / len(problem.target)
        return standard_deviations(jacobian, variance) / np.abs(values)


def motions() -> list[Record]:
    """Without force: a small slow sine, a large one, both kinds of motion at once about another
    displacement, and a sweep of 0.3 .. 12 Hz that is limited by its speed."""
    small = tones((0.7, 0.15 * STROKE_m, 0.0))
    large = tones((2.9, STROKE_m, 0.0))
    both = tones((0.9, 0.6 * STROKE_m, 0.5), (6.1, 0.15 * STROKE_m, 1.0))
    return [*(record_of(one, RATE_Hz, SAMPLES) for one in (small, large, both)), sweep()]


def tones(*several: tuple[float, float, float]) -> Tones:
    """Each frequency (Hz), amplitude (m), phase (rad)."""
    return Tones(*np.array(several).T)


def sweep(low_Hz: float = 0.3, high_Hz: float = 12.0) -> Record:
    """Logarithmic; its phase starts anew from rest at mid-stroke."""
    time_s = np.arange(SAMPLES) / RATE_Hz
    rise_1_s = np.log(high_Hz / low_Hz) / time_s[-1]
    rate = 2.0 * np.pi * low_Hz * np.exp(rise_1_s * time_s)
    phase = (rate - rate[0]) / rise_1_s
    # Amplitude a = b / (b / X + rate), with the speed limit b; and its derivatives.
    limit = 0.8 * SPEED_m_s
    below = limit / (0.8 * STROKE_m) + rate
    size = limit / below
    size1 = -limit * rise_1_s * rate / below**2
    size2 = -limit * rise_1_s**2 * rate * (below - 2.0 * rate) / below**3
    sine, cosine = np.sin(phase), np.cos(phase)
    disp = size * sine
    velocity = size1 * sine + size * rate * cosine
    accel = (
        size2 * sine
        + 2.0 * size1 * rate * cosine
        + size * (rise_1_s * rate * cosine - rate**2 * sine)
    )
    return motion_record(time_s, disp, velocity, accel, RATE_Hz)


def make_truth(one: Model, seed: int) -> Truth:
    """RuntimeError where no draw is fit for it: the model's search range is odd."""
    rng = np.random.default_rng([seed, *one.name.encode()])
    empty = motions()
    scales = Scales(
        FORCE_N,
        max(float(np.max(np.abs(record.disp_m))) for record in empty),
        max(float(np.max(np.abs(record.velocity_m_s))) for record in empty),
    )
    best: tuple[float, Truth] | None = None
    found = 0
    for draw in range(MOST_DRAWS):
        row = row_of(one, [drawn(parameter, scales, rng) for parameter in one.parameters])
        truth = simulated(one, row, empty, MOST_SUBSTEPS[draw >= FIRST_DRAWS])
        if truth is None or not is_inside(truth):
            continue
        worst = float(np.max(truth.deviations()))
        if best is None or worst < best[0]:
            best = worst, truth
        found += 1
        if worst <= DETERMINED or found == DRAWS:
            break
    if best is None:
        raise RuntimeError(f"{one.name}: no truth in {MOST_DRAWS} draws")
    return best[1]


def drawn(parameter: library.Parameter, scales: Scales, rng: np.random.Generator) -> float:
    low, high = parameter.search_range(scales)
    if parameter.search_low == parameter.search_high:
        return low
    variable = make_variable(
        parameter.name,
        parameter.unit,
        0,
        0,
        None,
        (low, high),
        (parameter.min, parameter.max),
        parameter.is_linear,
        parameter.natural(scales),
    )
    while True:
        value = float(variable.to_value(np.array(rng.uniform(*MIDDLE))))
        if variable.is_log or abs(value) >= LEAST * max(abs(low), abs(high)):
            return value


def simulated(one: Model, row: np.ndarray, empty: list[Record], most_substeps: int) -> Truth | None:
    """None where the force is not sensible or takes too many steps."""
    records = []
    for record in empty:
        if finest_steps(one, row, record, 1) > most_substeps:
            return None
        force_N = force_of(one, row, record, finest_steps(one, row, record))
        records.append(with_force(record, force_N))
    largest_N = max(float(np.max(np.abs(record.force_N))) for record in records)
    return Truth(one, row, records) if _FORCES_N[0] <= largest_N <= _FORCES_N[1] else None


def is_inside(truth: Truth) -> bool:
    """Whether the nonlinear variables lie in the search ranges of a fit."""
    problem = truth.problem()
    return all(
        one.is_linear or one.search[0] <= value <= one.search[1]
        for one, value in zip(problem.variables, truth.values(problem), strict=True)
    )
