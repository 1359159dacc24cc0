"""How the training part is divided for validation: whole currents, motions and amplitudes left out
in turn, as far as the data allow.

A fold stands for one kind of new data. Where nothing whole can be left out, or all tests are one
long one, quarters of every test are left out: those stand for other rows of the same tests alone.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from quiesce.damper.data.record import Record
from quiesce.damper.data.split import Part, Segment, is_switched, levels_of

CURRENT, MOTION, AMPLITUDE, QUARTERS = "current", "motion", "amplitude", "rows"
# What an error of each kind stands for, in words.
STANDS_FOR = {
    CURRENT: "another current between those of the data",
    MOTION: "another motion (amplitude or frequency)",
    AMPLITUDE: "another amplitude",
    QUARTERS: "other rows of the same tests",
}
# What each kind leaves out, in words.
LEAVES_OUT = {
    CURRENT: "whole currents",
    MOTION: "whole motions",
    AMPLITUDE: "whole amplitudes",
    QUARTERS: "quarters of every test",
}
# Folds of a kind at most: usually, and with --effort quick.
MOST, MOST_QUICK = 3, 2
# Amplitudes or frequencies this close (ratio less one) are the same.
_SAME = 0.15
# Quarters of every test that are left out in turn where nothing whole can be.
_LEFT_OUT = (3, 1)
# Fewer rows than this validate nothing.
_LEAST_ROWS = 8


@dataclass(frozen=True)
class Fold:
    """Rows to fit and rows to validate on; `kind` is one of STANDS_FOR, `left_out` says in words
    what the fit does not see. `is_harder`: it leaves two levels of three, so that current laws are
    straight lines where all rows tell of a bend."""

    kind: str
    left_out: str
    fit: list[Segment]
    validation: list[Segment]
    is_harder: bool = False


def folds_of(segments: Sequence[Segment], most: int = MOST) -> list[Fold]:
    """At least one; at most `most` of a kind, spread evenly.

    Currents: the inner levels where every test has a constant command; without the lowest or the
    highest a model would have to extrapolate. Motions and amplitudes: those without which every
    level is still there, so that a fold does not ask two things at once.
    """
    found = [
        *spread(current_folds(segments), most),
        *spread(motion_folds(segments), most),
        *spread(amplitude_folds(segments), most),
    ]
    if all(one.is_harder for one in found):
        found += spread(row_folds(segments), most)
    return found


def spread(folds: list[Fold], most: int) -> list[Fold]:
    if len(folds) <= most:
        return folds
    places = np.unique(np.linspace(0, len(folds) - 1, most).round().astype(int))
    return [folds[k] for k in places]


def current_folds(segments: Sequence[Segment]) -> list[Fold]:
    if any(one.record.level is None for one in segments):
        return []
    unit = segments[0].record.command_unit
    levels = levels_of(segments)
    found = [
        fold(CURRENT, f"{level:g} {unit}", segments, Part("current_A", (level,)).has_level)
        for level in levels[1:-1]
    ]
    return [replace(one, is_harder=len(levels) == 3) for one in found]


def motion_folds(segments: Sequence[Segment]) -> list[Fold]:
    """Tests of one amplitude and one frequency. Where all frequencies are the same these are the
    amplitudes, and left to them."""
    if len(groups_of(segments, freq_of)) == 1:
        return []
    return [
        one
        for members in groups_of(segments, motion_of)
        if (one := without(MOTION, segments, members, motion_text(members))) is not None
    ]


def amplitude_folds(segments: Sequence[Segment]) -> list[Fold]:
    """Tests of one amplitude. Where frequencies differ an amplitude of a single motion is left out
    with that already."""
    is_one_freq = len(groups_of(segments, freq_of)) == 1
    return [
        one
        for members in groups_of(segments, amplitude_of)
        if is_one_freq or len(groups_of(members, freq_of)) > 1
        if (one := without(AMPLITUDE, segments, members, amplitude_text(members))) is not None
    ]


def row_folds(segments: Sequence[Segment]) -> list[Fold]:
    """A quarter of every segment left out; the last one first."""
    names = ("first", "second", "third", "last")
    found = []
    for quarter in _LEFT_OUT:
        fit: list[Segment] = []
        validation: list[Segment] = []
        for one in segments:
            cuts = [one.first + round(0.25 * k * len(one)) for k in range(5)]
            first, end = cuts[quarter], max(cuts[quarter + 1], cuts[quarter] + 1)
            validation.append(Segment(one.record, first, min(end, one.end)))
            for part in (Segment(one.record, one.first, first), Segment(one.record, end, one.end)):
                fit += [part] if len(part) > 0 else []
        found.append(Fold(QUARTERS, f"the {names[quarter]} quarter", fit, validation))
    is_long = min(len(one) for one in segments) >= 4 * _LEAST_ROWS
    return found if is_long else found[:1]


def fold(
    kind: str, left_out: str, segments: Sequence[Segment], is_left_out: Callable[[Record], bool]
) -> Fold:
    return Fold(
        kind,
        left_out,
        [one for one in segments if not is_left_out(one.record)],
        [one for one in segments if is_left_out(one.record)],
    )


def without(
    kind: str, segments: Sequence[Segment], members: Sequence[Segment], text: str
) -> Fold | None:
    """None where what remains lacks a level, or is nothing."""
    names = {id(one.record) for one in members}
    found = fold(kind, text, segments, lambda record: id(record) in names)
    is_whole = len(levels_of(found.fit)) == len(levels_of(segments)) and is_switched(
        found.fit
    ) == is_switched(segments)
    return found if found.fit and is_whole else None


# Motions


def amplitude_of(segment: Segment) -> tuple[float, ...]:
    """Half the span of the displacement, but for the outermost hundredth, in m."""
    low, high = np.quantile(segment.record.disp_m[segment.rows], [0.01, 0.99])
    return (0.5 * float(high - low),)


def freq_of(segment: Segment) -> tuple[float, ...]:
    """Of a sine with this ratio of speed to displacement, in Hz."""
    rows = segment.rows
    speed_m_s = float(np.std(segment.record.velocity_m_s[rows]))
    disp_m = float(np.std(segment.record.disp_m[rows]))
    return (speed_m_s / max(2.0 * np.pi * disp_m, 1e-12),)


def motion_of(segment: Segment) -> tuple[float, ...]:
    return (*amplitude_of(segment), *freq_of(segment))


def groups_of(
    segments: Sequence[Segment], size_of: Callable[[Segment], tuple[float, ...]]
) -> list[list[Segment]]:
    """Segments whose sizes agree within _SAME of a group's first, rising by the first size."""
    groups: list[tuple[np.ndarray, list[Segment]]] = []
    for one in segments:
        sizes = np.log(np.maximum(size_of(one), 1e-12))
        for first, members in groups:
            if np.max(np.abs(sizes - first)) <= np.log1p(_SAME):
                members.append(one)
                break
        else:
            groups.append((sizes, [one]))
    return [members for _, members in sorted(groups, key=lambda pair: tuple(pair[0]))]


def amplitude_text(members: Sequence[Segment]) -> str:
    return f"{1e3 * amplitude_of(members[0])[0]:.2g} mm"


def motion_text(members: Sequence[Segment]) -> str:
    return f"{amplitude_text(members)} at {freq_of(members[0])[0]:.2g} Hz"
