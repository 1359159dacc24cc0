"""A bank for tracker `bank` from the forces of any damper model at constant currents.

Every model of a bank weighs the same elements (firmware/track/force_bank.h). They are chosen from
stops, saturations of the velocity and Maxwell elements over the damper's stroke and speed, on
motions large and small; weights are not negative, so that what is made is passive, but for spring
and offset, whatever the damper's model is.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from quiesce.base.errors import UsageError
from quiesce.damper.bank.choose import Products, choose
from quiesce.damper.bank.table import (
    LEAD_ONE,
    LIMIT,
    MAX_CURRENTS,
    MAX_ELEMENTS,
    MAX_SHIFT,
    ONE,
    SUM_LIMIT,
    Bank,
    ConstantModel,
    Element,
    MAX_CURRENT_mA,
    clipped_sums,
    largest_sum,
)
from quiesce.damper.data.record import Record
from quiesce.damper.excitation import ramps, random_motion, sine, sweep, times
from quiesce.damper.inverse import Forces, check_finite
from quiesce.damper.inverses.excited import SPEED_PART, STROKE_PART, moved
from quiesce.damper.model_file import DamperModel

DURATION_s = 6.0
# Forces are whole mN: less than this between no current and the largest one is told too coarsely.
LEAST_RANGE_mN = 100
# Of the forces of all models, on motions that it was not fitted to: a worse bank is none.
WORST_ERROR_PCT = 25.0
# A lead costs a stroke: it has to take this part of the error away, and more than a small one.
WORTH_A_LEAD = 0.3
SMALL_ERROR = 0.004
WEIGHT_LIMIT = 2**31 - 1
_ALWAYS = 4  # signals: offset and spring, each up and down


@dataclass(frozen=True)
class Reach:
    """What the motions go through at most."""

    stroke_m: float
    speed_m_s: float
    rate_Hz: int

    @classmethod
    def of(cls, damper: DamperModel, rate_Hz: int) -> "Reach":
        """UsageError where the damper's file states no stroke or no speed."""
        if not (damper.speed_m_s > 0.0 and damper.stroke_m > 0.0):
            raise UsageError(
                f"{damper.name}: the file states no stroke or no speed; --amplitude-mm and "
                "--max-speed-m-s do"
            )
        return cls(STROKE_PART * damper.stroke_m, SPEED_PART * damper.speed_m_s, rate_Hz)


@dataclass(frozen=True)
class Candidates:
    """Elements [elements] to choose from; limits in m/s."""

    leads: np.ndarray
    leak: np.ndarray
    limit_m_s: np.ndarray

    def beside(self, other: "Candidates") -> "Candidates":
        return Candidates(
            np.concatenate([self.leads, other.leads]),
            np.concatenate([self.leak, other.leak]),
            np.concatenate([self.limit_m_s, other.limit_m_s]),
        )


@dataclass(frozen=True)
class Lead:
    per_s: float
    most_m_s: float


NO_LEAD = Lead(0.0, 0.0)


@dataclass(frozen=True)
class FittedBank:
    bank: Bank
    error_pct: np.ndarray  # of each model's force, on motions that it was not fitted to
    mean_error_pct: float  # of all of them together


def candidates_for(reach: Reach) -> Candidates:
    """Stops from a ten-thousandth of the stroke on, saturations from a three-hundredth of the speed
    on, and both with leaks between 2 and 250 ms."""
    never = 1e-6 * LIMIT
    rows = [(0.0, travel * reach.rate_Hz) for travel in reach.stroke_m * np.logspace(-4, 0, 17)]
    rows += [(1.0, limit) for limit in reach.speed_m_s * np.logspace(-2.5, 0, 13)]
    rows.append((1.0, never))
    for time_s in (0.002, 0.004, 0.008, 0.016, 0.03, 0.06, 0.12, 0.25):
        leak = 1.0 - np.exp(-1.0 / (reach.rate_Hz * time_s))
        rows.append((leak, never))
        rows += [(leak, speed / leak) for speed in reach.speed_m_s * np.logspace(-1.5, -0.2, 6)]
    leak, limit_m_s = np.array(rows).T
    return Candidates(np.zeros(len(rows), dtype=bool), leak, np.minimum(limit_m_s, never))


def leading_for(reach: Reach) -> Candidates:
    limits = reach.speed_m_s * np.logspace(-2, 0, 9)
    return Candidates(np.ones(len(limits), dtype=bool), np.ones(len(limits)), limits)


def leads_for(reach: Reach) -> list[Lead]:
    return [
        Lead(float(most / place), float(most))
        for most in reach.speed_m_s * np.array([0.03, 0.07, 0.15, 0.3, 0.6])
        for place in reach.stroke_m * np.array([0.02, 0.1, 0.4, 1.0])
    ]


def fit_motions(reach: Reach, seed: int) -> list[Record]:
    """Sines and random motions, large and small."""
    time_s = times(DURATION_s, reach.rate_Hz)

    def tone(part: float, freq_Hz: float) -> np.ndarray:
        most_m = reach.speed_m_s / (2.0 * np.pi * freq_Hz)
        return sine(time_s, min(part * reach.stroke_m, most_m), freq_Hz)

    tones = [tone(*one) for one in ((1.0, 1.0), (0.3, 3.0), (0.1, 5.0), (0.03, 8.0), (0.3, 0.5))]
    noises = ((1.0, 0.3, 3.0), (0.5, 0.5, 8.0), (0.15, 0.5, 15.0), (0.05, 1.0, 20.0))
    return _records(time_s, [*tones, *(_noise(reach, time_s, *n, seed) for n in noises)])


def judge_motions(reach: Reach, seed: int) -> list[Record]:
    """Random motions of other bands, a sweep and ramps."""
    time_s = times(DURATION_s, reach.rate_Hz)
    stroke_m, speed_m_s = reach.stroke_m, reach.speed_m_s
    noises = ((0.8, 0.4, 5.0), (0.3, 0.5, 10.0), (0.1, 0.5, 12.0))
    others = [
        sweep(time_s, 0.6 * stroke_m, 0.7 * speed_m_s, 0.5, 8.0),
        ramps(time_s, 0.5 * stroke_m, 0.3 * speed_m_s),
    ]
    return _records(time_s, [*(_noise(reach, time_s, *n, seed + 1) for n in noises), *others])


def _noise(
    reach: Reach, time_s: np.ndarray, part: float, low_Hz: float, high_Hz: float, seed: int
) -> np.ndarray:
    band = (low_Hz, high_Hz)
    return random_motion(time_s, part * reach.stroke_m, part * reach.speed_m_s, band, seed)


def _records(time_s: np.ndarray, motions: Sequence[np.ndarray]) -> list[Record]:
    return [moved("motion", time_s, disp_m, np.zeros(len(time_s))) for disp_m in motions]


@dataclass(frozen=True)
class Test:
    """Motions [motions, ticks] and their forces [models, motions x ticks]."""

    stroke_m: np.ndarray
    velocity_m_s: np.ndarray
    force_N: np.ndarray

    @classmethod
    def of(cls, records: Sequence[Record], forces: Forces, currents_A: np.ndarray) -> "Test":
        return cls(
            np.stack([one.disp_m for one in records]),
            np.stack([one.velocity_m_s for one in records]),
            np.concatenate([forces(one, currents_A) for one in records], axis=1),
        )

    def states(self, of: Candidates, lead: Lead) -> np.ndarray:
        """[motions x ticks, elements] in m/s."""
        led = np.clip(lead.per_s * self.stroke_m, -lead.most_m_s, lead.most_m_s)
        both = np.stack([self.velocity_m_s, self.velocity_m_s + led], axis=-1)
        along = np.moveaxis(both[:, :, of.leads.astype(int)], 0, 1)
        z = clipped_sums(along, of.leak, of.limit_m_s)
        return np.moveaxis(z, 1, 0).reshape(-1, len(of.leak))


def currents_mA(most_A: float) -> np.ndarray:
    """Whole mA from 0 on. UsageError where there are no two, or it is too much."""
    most_mA = int(1e3 * most_A * (1.0 + 1e-12))
    if not 1 <= most_mA <= MAX_CURRENT_mA:
        raise UsageError(f"a bank goes up to 0.001 .. 20 A; --max-current-A {most_A:g} is not")
    return np.unique(np.rint(np.linspace(0.0, most_mA, MAX_CURRENTS)).astype(int))


def fit_bank(
    damper: DamperModel,
    forces: Forces,
    most_A: float,
    rate_Hz: int,
    seed: int,
    progress: Callable[[str], None],
) -> FittedBank:
    """UsageError, in one line, where there is none."""
    reach = Reach.of(damper, rate_Hz)
    currents = currents_mA(most_A)
    fitted = Test.of(fit_motions(reach, seed), forces, 1e-3 * currents)
    judge = Test.of(judge_motions(reach, seed), forces, 1e-3 * currents)
    _check_forces(damper, np.hstack([fitted.force_N, judge.force_N]))
    bank = _best(reach, fitted, currents, progress)
    found = judged(bank, judge)
    if found.mean_error_pct > WORST_ERROR_PCT:
        raise UsageError(
            f"{damper.name}: no bank: it misses {found.mean_error_pct:.0f} % of the model's force, "
            f"more than {WORST_ERROR_PCT:g} %; a map may do (--method map)"
        )
    return found


def _check_forces(damper: DamperModel, force_N: np.ndarray) -> None:
    check_finite(damper, force_N)
    largest_N = float(np.abs(force_N).max())
    if 1e3 * largest_N > LIMIT:
        raise UsageError(f"{damper.name}: no bank: {largest_N:.4g} N are more than 1073741 N")
    spread_mN = 1e3 * float(np.ptp(force_N, axis=0).max())
    if spread_mN < LEAST_RANGE_mN:
        raise UsageError(
            f"{damper.name}: no bank: the current changes the force by {spread_mN:.3g} mN at most, "
            "and forces are whole mN"
        )


def judged(bank: Bank, test: Test) -> FittedBank:
    pairs = zip(test.stroke_m, test.velocity_m_s, strict=True)
    said = np.concatenate([bank.forces_N(*one) for one in pairs], axis=1)
    missed, size = np.mean((said - test.force_N) ** 2, axis=1), np.mean(test.force_N**2, axis=1)
    errors = 100.0 * np.sqrt(missed / np.maximum(size, 1e-300))
    return FittedBank(bank, errors, float(100.0 * np.sqrt(missed.sum() / size.sum())))


def _best(reach: Reach, test: Test, currents: np.ndarray, progress: Callable[[str], None]) -> Bank:
    """Without a lead, or with one where it is worth its stroke."""
    plain = candidates_for(reach)
    ones = np.ones(test.stroke_m.size)
    stroke_m = test.stroke_m.ravel()
    signals = np.column_stack([ones, -ones, stroke_m, -stroke_m, test.states(plain, NO_LEAD)])
    error, chosen, weights = _chosen(signals, test)
    best = (error, NO_LEAD, plain, chosen, weights)
    progress(f"bank: {len(chosen)} elements of {len(plain.leak)}")
    if error > SMALL_ERROR * len(currents):
        leading = leading_for(reach)
        goal = (1.0 - WORTH_A_LEAD) * error
        for lead in leads_for(reach):
            also = np.hstack([signals, test.states(leading, lead)])
            error, chosen, weights = _chosen(also, test)
            if error < min(goal, best[0]):
                best = (error, lead, plain.beside(leading), chosen, weights)
        progress(f"bank: {'no lead is worth a stroke' if best[1] is NO_LEAD else 'with a lead'}")
    _, lead, of, chosen, weights = best
    return _compiled(reach, lead, of, [one - _ALWAYS for one in chosen], weights, currents)


def _chosen(signals: np.ndarray, test: Test) -> tuple[float, list[int], np.ndarray]:
    candidates = range(_ALWAYS, signals.shape[1])
    return choose(Products.of(signals, test.force_N), range(_ALWAYS), candidates, MAX_ELEMENTS)


def _compiled(
    reach: Reach,
    lead: Lead,
    of: Candidates,
    chosen: Sequence[int],
    weights: np.ndarray,
    currents: np.ndarray,
) -> Bank:
    """Integers of weights [models, offset up and down, spring up and down, chosen] in N, N/m and
    N s/m: the largest shift with which they fit."""
    elements = tuple(
        Element(
            bool(of.leads[one]),
            round(float(of.leak[one]) * ONE),
            max(1, min(LIMIT, round(1e6 * float(of.limit_m_s[one])))),
        )
        for one in chosen
    )
    offset_mN = np.clip(np.rint(1e3 * (weights[:, 0] - weights[:, 1])), -LIMIT, LIMIT).astype(int)
    exact = np.column_stack([1e-6 * (weights[:, 2] - weights[:, 3]), 1e-3 * weights[:, _ALWAYS:]])
    for shift in range(MAX_SHIFT, -1, -1):
        rows = np.rint(np.ldexp(exact, shift))
        if np.abs(rows).max() > WEIGHT_LIMIT:
            continue
        models = tuple(
            ConstantModel(int(mA), int(mN), int(row[0]), tuple(int(one) for one in row[1:]))
            for mA, mN, row in zip(currents, offset_mN, rows, strict=True)
        )
        if all(largest_sum(elements, one) <= SUM_LIMIT for one in models):
            gain = 0 if lead is NO_LEAD else round(1e-3 * lead.per_s * LEAD_ONE)
            most = round(1e6 * lead.most_m_s)
            return Bank(reach.rate_Hz, shift, gain, most, elements, models)
    raise UsageError("no bank: its weights are too large for the controller's integers")
