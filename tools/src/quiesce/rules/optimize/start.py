"""The paper's own recipe for a rule base: sets where it was measured, consequents from the lookup.

Frequency sets have their tops at the measured frequencies, four RMS sets at fixed shares of the
strongest vibration; every rule names the output term nearest to the current of least RMS
acceleration at its frequency, over all drives. For the published plant at 5, 10, 15 and 20 Hz this
is the rule base that the controller ships with.
"""

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from quiesce.base.errors import UsageError
from quiesce.base.paths import shown
from quiesce.engine.scenarios import read_toml
from quiesce.rules.model import (
    WEIGHTED_SUM,
    Condition,
    FuzzySet,
    Input,
    Output,
    Rule,
    RuleBase,
    Singleton,
    trapezoid,
)
from quiesce.rules.optimize.lookup import Sweep, accel_left

FREQS_Hz = (5.0, 10.0, 15.0, 20.0)
AROUND = (0.5, 1.0, 1.5)  # one frequency
SPREAD = 4  # sets over a band
BANDS = ("chirp", "random")
FREQ_NAMES = {
    2: ("S", "VH"),
    3: ("S", "M", "H"),
    4: ("S", "M", "H", "VH"),
    5: ("S", "M", "H", "VH", "XH"),
    6: ("S", "MS", "M", "H", "VH", "XH"),
    7: ("VS", "S", "MS", "M", "H", "VH", "XH"),
}
RMS_NAMES = ("S", "M", "H", "VH")
RMS_SHARES = (1 / 9, 1 / 3, 2 / 3, 1.0)
TERM_NAMES = ("Z", "S", "M", "L", "VL")
INFINITE = float("inf")


def start_freqs_Hz(files: Sequence[Path], is_published: bool) -> list[float]:
    """Where the recipe has its sets: at the frequencies of the scenarios, a few of them where they
    are many, or spread over their bands. is_published: the plant is, and so are its frequencies.
    UsageError where they have none."""
    if is_published:
        return list(FREQS_Hz)
    segments = [segment for file in files for segment in read_toml(file)["segment"]]
    own = {float(freq_Hz) for segment in segments for freq_Hz in frequencies_of(segment)}
    freqs_Hz = sorted(own)
    if not freqs_Hz:
        raise UsageError(
            f"{shown(files[0])} has no frequency for the sets of a rule base to begin with; give "
            "--start FILE ('quiesce rules lookup --write' makes one), or --freq"
        )
    if len(freqs_Hz) == 1:
        return [part * freqs_Hz[0] for part in AROUND]
    is_band = any(segment["kind"] in BANDS for segment in segments)
    if is_band or len(freqs_Hz) > max(FREQ_NAMES):
        return spread_Hz(freqs_Hz[0], freqs_Hz[-1])
    return freqs_Hz


def frequencies_of(segment: dict[str, Any]) -> list[float]:
    found = [
        segment[key] for key in ("freq_Hz", "end_freq_Hz", "low_Hz", "high_Hz") if key in segment
    ]
    return found + [tone["freq_Hz"] for tone in segment.get("tone", [])]


def spread_Hz(low_Hz: float, high_Hz: float) -> list[float]:
    gap_Hz = (high_Hz - low_Hz) / (SPREAD - 1)
    return [float(f"{low_Hz + i * gap_Hz:.4g}") for i in range(SPREAD)]


def chain(names: Sequence[str], tops: Sequence[float]) -> tuple[FuzzySet, ...]:
    """Triangles at the tops, shoulders at both ends; neighbours add up to 1."""
    ends = [-INFINITE, *tops, INFINITE]
    found = []
    for i, (name, top) in enumerate(zip(names, tops, strict=True)):
        left, right = ends[i], ends[i + 2]
        # A shoulder's plateau ends in the universe's end, however far that is.
        low = -INFINITE if i == 0 else top
        high = INFINITE if i == len(tops) - 1 else top
        found.append(trapezoid(name, left, low, high, right))
    return tuple(found)


def round_up(value: float) -> float:
    """To the next multiple of half its power of ten: 0.42 -> 0.45."""
    step = 10.0 ** math.floor(math.log10(value)) / 2
    return round(math.ceil(value / step - 1e-9) * step, 12)


def nearest_term(current_A: float, terms: Sequence[Singleton]) -> int:
    return min(range(len(terms)), key=lambda i: abs(terms[i].value - current_A))


def best_current_A(found: Sweep, freq_Hz: float) -> float:
    """Of least RMS acceleration at a frequency, the mean over its drives."""
    at = [i for i, place in enumerate(found.places) if place.freq_Hz == freq_Hz]
    return sum(found.best(i, accel_left)[0] for i in at) / len(at) / 1000.0


def freq_input(freqs_Hz: Sequence[float]) -> Input:
    step_Hz = (freqs_Hz[-1] - freqs_Hz[0]) / (len(freqs_Hz) - 1)
    return Input("f", 0.0, freqs_Hz[-1] + step_Hz, chain(FREQ_NAMES[len(freqs_Hz)], freqs_Hz))


def rms_input(strongest_m_s2: float) -> Input:
    top = round_up(strongest_m_s2)
    tops = [round(share * top, 12) for share in RMS_SHARES]
    return Input("a", 0.0, round(top / 0.9, 12), chain(RMS_NAMES, tops))


def recipe_base(found: Sweep, name: str, max_current_A: float) -> RuleBase:
    """UsageError where the sweep has too few frequencies or too many for sets."""
    freqs_Hz = sorted({place.freq_Hz for place in found.places})
    if len(freqs_Hz) not in FREQ_NAMES:
        raise UsageError(
            f"a rule base needs 2 .. {max(FREQ_NAMES)} frequencies, a set for each; "
            f"{len(freqs_Hz)} were given"
        )
    last = len(TERM_NAMES) - 1
    terms = tuple(Singleton(n, max_current_A * i / last) for i, n in enumerate(TERM_NAMES))
    inputs = (
        freq_input(freqs_Hz),
        rms_input(1e-3 * max(place.accel_rms_mm_s2 for place in found.places)),
    )
    row = [nearest_term(best_current_A(found, freq_Hz), terms) for freq_Hz in freqs_Hz]
    rules = tuple(
        Rule((Condition(0, i), Condition(1, j)), (row[i],))
        for i in range(len(freqs_Hz))
        for j in range(len(RMS_NAMES))
    )
    output = Output("I", 0.0, max_current_A, terms, WEIGHTED_SUM, default=0.0)
    return RuleBase(name, inputs, (output,), rules)
