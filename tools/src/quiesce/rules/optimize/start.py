"""The paper's own recipe for a rule base: sets where it was measured, consequents from the lookup.

Frequency sets have their tops at the measured frequencies, four RMS sets at fixed shares of the
strongest vibration; every rule names the output term nearest to the current of least RMS
acceleration at its frequency, over all drives. For the published plant at 5, 10, 15 and 20 Hz this
is the rule base that the controller ships with.
"""

import math
from collections.abc import Sequence

from quiesce.base.errors import UsageError
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
