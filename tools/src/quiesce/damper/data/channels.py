"""Channels that look saturated, frozen, drifting or late, whatever noise and filters hide.

Judged is the file before it is filtered. Each channel is smoothed over a thirtieth of a cycle of
the motion, so that sensor noise and the ringing of a low-pass do not hide what is flat. On which
files the numbers below were set is in docs/reference/damper-data-files.md.
"""

from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import permutations

import numpy as np

from quiesce.damper.data.read import RawTest
from quiesce.damper.data.record import NOISE_LEAST, Record

# Parts of a cycle: smoothing, and the spacing of the rows that are kept.
_SMOOTH_CYCLES = 1.0 / 30.0
_ROWS_A_CYCLE = 100
_MOST_ROWS = 20_000
_WIDEST = 31
_LEAST_ROWS = 3  # of a run
# A channel is flat while it stays within this part of its span.
_FLAT = 0.005
# Clipped: two runs at one level in the outer tenth of the span, each this part of a cycle. On the
# measured files the longest is 0.13; clipped at 0.8 of their peak the shortest is 0.17.
_OUTER = 0.1
_CLIPPED_CYCLES = 0.16
_CLIPPED_PART = 1.0 / 6.0  # of all cycles
# Or, in the file as it is: so many runs of so many rows at exactly the end.
_AT_END = 3
# At constant speed a damper's force is flat by nature.
_SPEED_CHANGE = 0.08
# Frozen: within this part of its span for this part of a cycle, while the other channel goes to and
# fro by a part of its own. Displacement rests at a turn of the motion, force between two of them.
_STILL = 0.02
_STILL_CYCLES = 0.3
_SLOW_QUANTILE = 0.9
_TO_AND_FRO = 0.1
# Or, for a force over a motion that stands still: by itself it falls to zero, not across it.
_ACROSS = 0.7
# Of the force's half span, over the test, in at least so many cycles, and along a straight line.
_DRIFT = 0.15
_DRIFT_CYCLES = 5
_DRIFT_STRAIGHT = 0.8
# A velocity later than the displacement's slope by more than this part of a cycle.
_LATE_CYCLES = 0.02
# Forces at two commands are compared where the speeds are alike, and differ by so much.
_ALIKE_SPEEDS = 1.3
_LESS_FORCE = 0.8


@dataclass(frozen=True)
class Channels:
    """Smoothed and thinned, [n]; `cycle` in rows, about every row."""

    time_s: np.ndarray
    motion: np.ndarray  # m, or m/s where only a velocity was measured
    force_N: np.ndarray
    disp_m: np.ndarray
    cycle: np.ndarray
    motion_role: str


def suspicions(raw: RawTest) -> list[str]:
    """In plain sentences; none for channels that are as a damper's may be."""
    one = channels_of(raw)
    if one is None:
        return []
    found = [frozen_force(one), frozen_motion(one)]
    found.append(None if found[0] else clipped(one) or at_its_end(raw.si["force"]))
    found.append(drifting(one))
    found.append(late_velocity(raw))
    return [text for text in found if text]


def channels_of(raw: RawTest) -> Channels | None:
    """None where the motion has less than a cycle."""
    role = "displacement" if "displacement" in raw.si else "velocity"
    motion = raw.si[role]
    disp_m = motion if role == "displacement" else np.cumsum(motion - motion.mean()) * raw.period_s
    cycle = cycles_of(disp_m)
    if cycle is None:
        return None
    usual = float(np.median(cycle))
    width = max(1, round(_SMOOTH_CYCLES * usual))
    first = max(1, width // _WIDEST)  # a median over thousands of rows would take minutes
    step = max(1, round(usual / _ROWS_A_CYCLE / first), -(-len(motion) // (first * _MOST_ROWS)))
    picked = slice(None, None, first * step)
    smooth = [
        smoothed(one[::first], (width // first) | 1)[::step]
        for one in (motion, raw.si["force"], disp_m)
    ]
    return Channels(raw.time_s[picked], *smooth, cycle[picked] / (first * step), role)


def cycles_of(disp_m: np.ndarray) -> np.ndarray | None:
    """Rows a cycle of the motion, about every row: from its passages through the mean, those that
    noise repeats not counted."""
    centred = disp_m - disp_m.mean()
    side = np.where(np.abs(centred) > 0.2 * centred.std(), np.sign(centred), 0.0)
    rows = np.flatnonzero(side)
    turns = rows[1:][side[rows[1:]] != side[rows[:-1]]]
    if len(turns) < 3:
        return None
    whole = turns[2:] - turns[:-2]
    return np.interp(np.arange(len(disp_m)), turns[1:-1], whole)


def smoothed(values: np.ndarray, width: int) -> np.ndarray:
    """By a median, which leaves edges, then by a mean; `width` rows, odd."""
    from scipy.ndimage import median_filter, uniform_filter1d

    if width == 1:
        return values
    return uniform_filter1d(median_filter(values, width, mode="nearest"), width, mode="nearest")


def flat_runs(values: np.ndarray, band: float) -> list[tuple[int, int]]:
    """Longest first, apart from each other: rows first .. end - 1 that span at most `band`."""
    high: deque[int] = deque()
    low: deque[int] = deque()
    first, runs = 0, []
    for row, value in enumerate(values):
        while high and values[high[-1]] <= value:
            high.pop()
        while low and values[low[-1]] >= value:
            low.pop()
        high.append(row)
        low.append(row)
        if values[high[0]] - values[low[0]] > band:
            runs.append((first, row))
        while values[high[0]] - values[low[0]] > band:
            first = min(high[0], low[0]) + 1
            for end in (high, low):
                while end and end[0] < first:
                    end.popleft()
    runs.append((first, len(values)))
    taken = np.zeros(len(values), dtype=bool)
    apart = []
    for first, end in sorted(runs, key=lambda run: run[0] - run[1]):
        if end - first >= _LEAST_ROWS and not taken[first:end].any():
            taken[first:end] = True
            apart.append((first, end))
    return apart


# Flat


def frozen_force(one: Channels) -> str | None:
    """A force that stands still while the motion goes to and fro."""
    for rows in still(one, one.force_N):
        if to_and_fro(one.motion[rows]) >= _TO_AND_FRO * np.ptp(one.motion):
            return frozen_text(one, rows, "force", one.motion_role)
    return None


def frozen_motion(one: Channels) -> str | None:
    """A motion that stands still while the force goes to and fro, or from one side to the other."""
    span_N = float(np.ptp(one.force_N))
    for rows in still(one, one.motion):
        force_N = one.force_N[rows]
        if to_and_fro(force_N) >= _TO_AND_FRO * span_N or np.ptp(force_N) >= _ACROSS * span_N:
            return frozen_text(one, rows, one.motion_role, "force")
    return None


def still(one: Channels, values: np.ndarray) -> list[slice]:
    """Runs that are long for the motion there and for its slow cycles, longest first."""
    slow = float(np.quantile(one.cycle, _SLOW_QUANTILE))
    return [
        slice(first, end)
        for first, end in flat_runs(values, _STILL * float(np.ptp(values)))
        if end - first >= _STILL_CYCLES * max(slow, one.cycle[(first + end) // 2])
    ]


def frozen_text(one: Channels, rows: slice, name: str, other: str) -> str:
    return (
        f"the {name} stands still from {one.time_s[rows.start]:.4g} to "
        f"{one.time_s[rows.stop - 1]:.4g} s while the {other} goes on; models fitted to those rows "
        "are wrong: cut them off"
    )


def to_and_fro(values: np.ndarray) -> float:
    """The lesser of the largest rise and the largest fall."""
    rise = float(np.max(values - np.minimum.accumulate(values)))
    fall = float(np.max(np.maximum.accumulate(values) - values))
    return min(rise, fall)


def clipped(one: Channels) -> str | None:
    """A force whose peaks end at one level, again and again, while the speed changes."""
    span_N = float(np.ptp(one.force_N))
    speed = np.abs(np.gradient(one.disp_m))
    least = _SPEED_CHANGE * float(speed.max())
    often = max(2.0, _CLIPPED_PART * len(one.force_N) / float(np.median(one.cycle)))
    for sign, side in ((1.0, "upper"), (-1.0, "lower")):
        force_N = sign * one.force_N
        levels = [
            float(force_N[first:end].mean())
            for first, end in flat_runs(force_N, _FLAT * span_N)
            if end - first >= _CLIPPED_CYCLES * one.cycle[(first + end) // 2]
            and np.ptp(speed[inner(first, end)]) >= least
        ]
        levels = [level for level in levels if level >= force_N.max() - _OUTER * span_N]
        same = [sum(abs(level - each) <= _FLAT * span_N for each in levels) for level in levels]
        if same and max(same) >= often:
            level_N = sign * levels[int(np.argmax(same))]
            return saturated_text(max(same), level_N, f"its {side} end, while the speed changes")
    return None


def inner(first: int, end: int) -> slice:
    """Without the tenths at either end, into which smoothing carries the turns of the motion."""
    edge = (end - first) // 10
    return slice(first + edge, end - edge)


def at_its_end(force_N: np.ndarray) -> str | None:
    """A force that has exactly its largest or smallest value row after row, again and again."""
    for end_N, side in ((force_N.max(), "upper"), (force_N.min(), "lower")):
        at_end = np.concatenate([[0], (force_N == end_N).astype(int), [0]])
        turns = np.flatnonzero(np.diff(at_end))
        runs = int(np.count_nonzero(turns[1::2] - turns[::2] >= _AT_END))
        if runs >= _AT_END:
            return saturated_text(runs, float(end_N), f"exactly its {side} end")
    return None


def saturated_text(times: int, level_N: float, where: str) -> str:
    return (
        f"{times} times the force stays at {level_N:.4g} N, {where}: is its channel saturated? "
        "(pure friction looks the same)"
    )


# Slow, late


def drifting(one: Channels) -> str | None:
    """A force whose mean over a cycle moves, though that of the motion does not ask for it."""
    size = round(float(np.median(one.cycle)))
    count = len(one.force_N) // size
    if count < _DRIFT_CYCLES:
        return None
    means_N, means_m = (
        values[: count * size].reshape(count, size).mean(axis=1)
        for values in (one.force_N, one.disp_m)
    )
    trend = np.linspace(-0.5, 0.5, count)
    least_N = _DRIFT * 0.5 * float(np.ptp(one.force_N))
    # Alone and beside what the displacement's own mean asks for.
    change_N = float(trend @ (means_N - means_N.mean()) / (trend @ trend))
    asked = np.stack([trend, np.ones(count), means_m - means_m.mean()], axis=1)
    beside_N = float(np.linalg.lstsq(asked, means_N, rcond=None)[0][0])
    is_straight = abs(np.corrcoef(trend, means_N)[0, 1]) >= _DRIFT_STRAIGHT
    if not is_straight or min(abs(change_N), np.sign(change_N) * beside_N) <= least_N:
        return None
    return (
        f"the force's mean drifts by {change_N:.3g} N over the test: does its channel "
        "drift? --rig offset_N,drift_N_s fits that"
    )


def late_velocity(raw: RawTest) -> str | None:
    """A measured velocity that comes later or earlier than the displacement's slope."""
    if not {"displacement", "velocity"} <= set(raw.si):
        return None
    cycle = cycles_of(raw.si["displacement"])
    if cycle is None:
        return None
    usual = float(np.median(cycle))
    slope = smoothed(np.gradient(raw.si["displacement"]), max(1, round(_SMOOTH_CYCLES * usual)) | 1)
    lag = lag_of(raw.si["velocity"], slope, round(0.25 * usual))
    if abs(lag) <= max(1, _LATE_CYCLES * usual):
        return None
    side = "later" if lag > 0 else "earlier"
    return (
        f"the measured velocity comes {abs(lag) * raw.period_s:.3g} s {side} than the "
        "displacement's slope: are the channels shifted in time?"
    )


def lag_of(values: np.ndarray, reference: np.ndarray, most: int) -> int:
    """Rows by which `values` follow `reference`, where they are most alike."""
    from scipy.signal import correlate

    centred = (values - values.mean(), reference - reference.mean())
    alike = correlate(*centred, mode="full")
    middle = len(reference) - 1
    return int(np.argmax(alike[middle - most : middle + most + 1])) - most


# Tests beside each other


def falling_force(records: Sequence[Record]) -> str | None:
    """A force that falls where the command rises, at speeds that are alike."""
    steady = [one for one in records if one.level is not None]
    sizes = {
        id(one): (float(np.std(one.force_N)), float(np.std(one.velocity_m_s))) for one in steady
    }
    for low, high in permutations(steady, 2):
        (low_N, low_m_s), (high_N, high_m_s) = sizes[id(low)], sizes[id(high)]
        alike = max(low_m_s, high_m_s) <= _ALIKE_SPEEDS * min(low_m_s, high_m_s)
        rises = abs(high.level or 0.0) > abs(low.level or 0.0) + NOISE_LEAST
        if alike and rises and high_N < _LESS_FORCE * low_N:
            return (
                f"{high.name} has {high.level:g} {high.command_unit} and less force than "
                f"{low.name} with {low.level:g} {low.command_unit}, at a speed alike: are the "
                "commands interchanged?"
            )
    return None
