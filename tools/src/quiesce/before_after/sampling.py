"""From time stamps to even samples: what is missing, late, drifting or clipped is told."""

from dataclasses import dataclass

import numpy as np

from quiesce.base.errors import UsageError

MIN_SAMPLES = 256
# A stretch that is longer than this many samples without one cuts the recording.
MOST_FILLED = 3
GAP_PERIODS = 1.5
# Distance of a stamp from an even grid, in periods, from which it is told.
TOLD_JITTER = 0.25
# Samples at the very largest or smallest value, in a row, that are taken for a stop of the sensor.
CLIPPED_RUN = 3
CLIPPED_DROP = 8.0  # least fall beside such a run, in steps of the resolution
# Frequency of the sampling over the first and last tenth that differ by more are told.
TOLD_DRIFT = 1e-3


@dataclass(frozen=True)
class Stamps:
    """Samples of one channel as they came: seconds, and values that are finite."""

    where: str  # FILE, channel NAME: for messages
    time_s: np.ndarray
    values: np.ndarray


@dataclass(frozen=True)
class Even:
    """Samples at start_s + n / rate_Hz. doubts: lines about what was done or found."""

    start_s: float
    rate_Hz: float
    values: np.ndarray
    doubts: list[str]

    @property
    def duration_s(self) -> float:
        return len(self.values) / self.rate_Hz


def check(stamps: Stamps) -> None:
    """UsageError for time that goes back, stands still or is too short, and for no numbers."""
    bad = np.flatnonzero(~(np.isfinite(stamps.time_s) & np.isfinite(stamps.values)))
    if bad.size:
        raise UsageError(
            f"{stamps.where}: sample {bad[0] + 1} is no finite number; cut or repair the recording"
        )
    back = np.flatnonzero(np.diff(stamps.time_s) <= 0)
    if back.size:
        at = int(back[0])
        raise UsageError(
            f"{stamps.where}: time does not advance at sample {at + 2} ({stamps.time_s[at]:.6g} s, "
            f"then {stamps.time_s[at + 1]:.6g} s); sort the samples and drop duplicates"
        )
    if len(stamps.values) < MIN_SAMPLES:
        raise UsageError(
            f"{stamps.where}: {len(stamps.values)} samples; at least {MIN_SAMPLES} are needed, and "
            "half a minute makes narrow intervals"
        )


def even(stamps: Stamps) -> Even:
    """The longest stretch without a long gap, evenly sampled. UsageError as check() has it, or
    where that stretch is too short."""
    check(stamps)
    time_s, values = stamps.time_s, stamps.values
    steps = np.diff(time_s)
    period_s = float(np.median(steps))
    missing = np.where(steps > GAP_PERIODS * period_s, np.rint(steps / period_s) - 1, 0).astype(int)
    first, end = _longest(missing, len(values))
    doubts = _left_out(time_s, first, end, missing)
    time_s, values, missing = time_s[first:end], values[first:end], missing[first : end - 1]
    if len(values) < MIN_SAMPLES:
        raise UsageError(
            f"{stamps.where}: no stretch without gaps has {MIN_SAMPLES} samples; record without "
            "losses"
        )
    index = np.concatenate([[0], np.cumsum(1 + missing)])
    period_s = float((time_s[-1] - time_s[0]) / index[-1])
    doubts += _filled(missing) + _uneven(time_s, index, period_s) + _clipped(values)
    grid = np.interp(np.arange(index[-1] + 1), index, values)
    return Even(float(time_s[0]), 1.0 / period_s, grid, doubts)


def _longest(missing: np.ndarray, count: int) -> tuple[int, int]:
    edges = [0, *(np.flatnonzero(missing > MOST_FILLED) + 1).tolist(), count]
    spans = list(zip(edges[:-1], edges[1:], strict=True))
    return max(spans, key=lambda span: span[1] - span[0])


def _left_out(time_s: np.ndarray, first: int, end: int, missing: np.ndarray) -> list[str]:
    if end - first == len(time_s):
        return []
    gaps = missing[missing > MOST_FILLED]
    whole_s, used_s = time_s[-1] - time_s[0], time_s[end - 1] - time_s[first]
    return [
        f"{gaps.size} gap{'s' * (gaps.size > 1)} of up to {gaps.max()} samples: only the longest "
        f"stretch is used, {used_s:.3g} s of {whole_s:.3g} s"
    ]


def _filled(missing: np.ndarray) -> list[str]:
    total = int(missing.sum())
    if not total:
        return []
    return [f"{total} of {total + len(missing) + 1} samples are missing; filled by straight lines"]


def _uneven(time_s: np.ndarray, index: np.ndarray, period_s: float) -> list[str]:
    """Of the stamps against an even grid. A grid that bends from end to end is a drifting clock."""
    jitter = float(np.abs((time_s - time_s[0]) / period_s - index).max())
    tenth = max(len(time_s) // 10, 2)
    ends = [
        (part[-1] - part[0]) / (count[-1] - count[0])
        for part, count in (
            (time_s[:tenth], index[:tenth]),
            (time_s[-tenth:], index[-tenth:]),
        )
    ]
    drift = ends[1] / ends[0] - 1.0
    if jitter <= TOLD_JITTER:
        return []
    if abs(drift) > TOLD_DRIFT:
        return [
            f"its sampling drifts: the period at the end differs by {100 * drift:+.2f} % from that "
            "at the start; taken as even"
        ]
    return [
        f"time stamps are up to {jitter:.2g} periods away from an even grid; taken as even, which "
        "blurs high frequencies"
    ]


def _clipped(values: np.ndarray) -> list[str]:
    """Runs of one value at the very top or bottom that no coarse resolution explains."""
    steps = np.abs(np.diff(values))
    least = CLIPPED_DROP * float(steps.min(where=steps > 0.0, initial=np.inf))
    count = sum(
        end - start
        for edge in (values.max(), values.min())
        for start, end in _runs(values == edge)
        if end - start >= CLIPPED_RUN and _drop(values, start, end) > least
    )
    if not count:
        return []
    return [
        f"clipped: {count} samples stand at its largest or smallest value; peaks and RMS are "
        "larger in truth"
    ]


def _runs(is_in: np.ndarray) -> list[tuple[int, int]]:
    """First and end of each run of True."""
    edges = np.diff(np.concatenate([[False], is_in, [False]]).astype(int))
    pairs = zip(np.flatnonzero(edges == 1), np.flatnonzero(edges == -1), strict=True)
    return [(int(start), int(end)) for start, end in pairs]


def _drop(values: np.ndarray, start: int, end: int) -> float:
    """How far it falls on either side within as many samples as the run has, the lesser of both. A
    rounded parabola falls by four steps of the resolution there."""
    length = end - start
    sides = (values[max(start - length, 0) : start], values[end : end + length])
    falls = [float(np.abs(side - values[start]).max()) for side in sides if len(side)]
    return min(falls, default=0.0)
