"""A steady component of any origin: how soon after its start it is trusted, and whether what is
reported is the strongest one of the band where one is most of the motion."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from quiesce.base.paths import measurements
from quiesce.base.table import format_table

from quiesce_benchmarks.lock import waves
from quiesce_benchmarks.lock.waves import LINE_RATE_Hz, Wave
from quiesce_benchmarks.part import Effort, Measured
from quiesce_benchmarks.signal.records import Rig, make_rig
from quiesce_benchmarks.signal.response import ticks_until_first

TITLE = "tones: trusted soon, and the strongest one reported"
FIGURES = (
    ("first_valid_s_worst", "s", 1.3, "lower"),
    ("strongest_reported_pct", "%", 95.0, "higher"),
    ("valid_time_pct", "%", 80.0, "higher"),
)

# Starts: a record that is cut anywhere, given to a new controller.
CUT_s, EVERY_s = 2.504, 0.256  # whole lines
JUDGED_s = 2.0  # of a cut: there one component stands ABOVE over the rest
ABOVE_dB = 10.0
SHARE_OF_START = 1.0 - 1.0 / (1.0 + 10.0 ** (ABOVE_dB / 10.0))
NEAR_Hz, NEAR = 0.3, 0.02
LEAST_Hz, LEAST_TIMES = 2.0, 2.0  # of what the tracker takes for a component
# Whole records.
WINDOW_s, UPDATE_s = 2.0, 0.048
SHARE_OF_WINDOW = 0.6
LEAST_UPDATES = 15  # of a record
LONG_s = 10.0
LONG_BELOW_dB = (1.8, 20.0)  # 60 % of the energy and up
COUNT, QUICK_COUNT = 400, 60
COLUMNS = ("freq_is_valid", "freq_uHz")


@dataclass(frozen=True)
class Start:
    group: str
    name: str
    freq_Hz: float
    wait_s: float  # never: to the cut's end

    def row(self) -> list[str]:
        return [self.group, self.name, f"{self.freq_Hz:.2f}", f"{self.wait_s:.2f}"]


@dataclass(frozen=True)
class Told:
    """Updates of one record, of those windows where one component is most of it."""

    group: str
    name: str
    updates: int
    valid: int
    right: int

    def row(self) -> list[str]:
        counts = [f"{self.updates}", percent(self.valid, self.updates)]
        return [self.group, self.name, *counts, percent(self.right, self.valid)]


def percent(part: int, whole: int) -> str:
    return f"{100.0 * part / whole:.1f}" if whole else "-"


def is_judged(rig: Rig, freqs_Hz: np.ndarray, levels_m_s2: np.ndarray) -> np.ndarray:
    """A few cycles of the window, in the band, and well above what is noise to the tracker."""
    least_m_s2 = LEAST_TIMES * 1e-6 * rig.params["track_min_accel_um_s2"]
    in_band = (freqs_Hz >= LEAST_Hz) & (freqs_Hz <= rig.band_Hz[1])
    return in_band & (levels_m_s2 >= least_m_s2)


def starts_of(rig: Rig, wave: Wave) -> list[Start]:
    """Of its cuts, those that begin with a steady component."""
    lines = waves.lines_of(wave, rig.rate_Hz)
    judged, every = round(JUDGED_s * LINE_RATE_Hz), round(EVERY_s * LINE_RATE_Hz)
    first = np.arange(0, len(lines) - round(CUT_s * LINE_RATE_Hz) + 1, every)
    freqs_Hz, shares, levels = waves.strongest(lines[first[:, None] + np.arange(judged)])
    chosen = np.flatnonzero((shares >= SHARE_OF_START) & is_judged(rig, freqs_Hz, levels))
    if chosen.size == 0:
        return []
    at = first[chosen] * (rig.rate_Hz // LINE_RATE_Hz)
    out = rig.run(wave.accel_m_s2[at[:, None] + np.arange(rig.ticks(CUT_s))], COLUMNS)
    near_Hz = np.maximum(NEAR_Hz, NEAR * freqs_Hz[chosen])[:, None]
    is_near = np.abs(1e-6 * out["freq_uHz"] - freqs_Hz[chosen, None]) <= near_Hz
    is_good = is_near & (out["freq_is_valid"] > 0)
    wait_s = ticks_until_first(is_good, np.zeros(chosen.size, dtype=int)) / rig.rate_Hz
    names = [f"{wave.name}, from {one / LINE_RATE_Hz:g} s" for one in first[chosen]]
    return [
        Start(wave.group, name, float(freq_Hz), float(one_s))
        for name, freq_Hz, one_s in zip(names, freqs_Hz[chosen], wait_s, strict=True)
    ]


def told_of(rig: Rig, wave: Wave) -> Told:
    lines = waves.lines_of(wave, rig.rate_Hz)
    length, every = round(WINDOW_s * LINE_RATE_Hz), round(UPDATE_s * LINE_RATE_Hz)
    last = np.arange(length, len(lines), every)
    freqs_Hz, shares, levels = waves.strongest(lines[last[:, None] + np.arange(1 - length, 1)])
    out = rig.run(wave.accel_m_s2[None, :], COLUMNS)
    at = last * (rig.rate_Hz // LINE_RATE_Hz)
    is_one = (shares >= SHARE_OF_WINDOW) & is_judged(rig, freqs_Hz, levels)
    is_valid = is_one & (out["freq_is_valid"][0, at] > 0)
    is_right = is_valid & (np.abs(1e-6 * out["freq_uHz"][0, at] - freqs_Hz) <= NEAR_Hz)
    counts = (int(one.sum()) for one in (is_one, is_valid, is_right))
    return Told(wave.group, wave.name, *counts)


def least_pct(told: Iterable[Told], share: Callable[[Told], float]) -> float:
    """The mean over the records of each group, of the group where it is least."""
    groups: dict[str, list[float]] = {}
    for one in told:
        groups.setdefault(one.group, []).append(share(one))
    return 100.0 * min(float(np.mean(shares)) for shares in groups.values())


def measure(effort: Effort) -> Measured:
    rig = make_rig([])
    count = QUICK_COUNT if effort.is_quick else COUNT
    real = list(waves.recorded(measurements("vibration"), rig.rate_Hz))
    real += waves.quakes(measurements("earthquake"), rig.rate_Hz)
    short = list(waves.made_up(rig.rate_Hz, CUT_s, count, effort.seed, waves.BELOW_dB))
    long = list(waves.made_up(rig.rate_Hz, LONG_s, count // 4, effort.seed, LONG_BELOW_dB))
    starts = [one for wave in [*real, *short] for one in starts_of(rig, wave)]
    told = [told_of(rig, wave) for wave in [*real, *long]]
    judged = [one for one in told if one.updates >= LEAST_UPDATES]
    trusted = [one for one in judged if one.valid > 0]
    return Measured(
        {
            "first_valid_s_worst": max(one.wait_s for one in starts),
            "strongest_reported_pct": least_pct(trusted, lambda one: one.right / one.valid),
            "valid_time_pct": least_pct(judged, lambda one: one.valid / one.updates),
        },
        {"starts": len(starts), "told": [one.row() for one in judged]},
        tables_of(starts, judged),
    )


def tables_of(starts: Sequence[Start], told: Sequence[Told]) -> tuple[str, ...]:
    latest = sorted(starts, key=lambda one: -one.wait_s)[:20]
    first = format_table(
        ["latest starts of", "", "Hz", "trusted\nafter s"], [x.row() for x in latest]
    )
    heads = ["record", "", "updates of\none line", "valid\n%", "right of\nvalid %"]
    return (first, format_table(heads, [one.row() for one in told]))
