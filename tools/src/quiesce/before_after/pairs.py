"""Which channel of one recording is which of the other, both in SI units at one rate."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from quiesce.base.errors import UsageError
from quiesce.base.paths import shown
from quiesce.before_after.files.source import Source
from quiesce.before_after.motion import Motion, Scale, Wanted
from quiesce.before_after.sampling import MIN_SAMPLES, Even, Stamps, even
from quiesce.signal.resample import resample

SIDES = ("before", "after")
MOST_CHANNELS = 12
MOST_NAMED = 8  # of the others
# Rates that differ by less are one: a hundredth of a band's width at the most.
SAME_RATE = 2e-4


@dataclass(frozen=True)
class Side:
    """One channel of one recording, SI units, at start_s + n / rate_Hz."""

    start_s: float
    rate_Hz: float
    values: np.ndarray

    @property
    def duration_s(self) -> float:
        return len(self.values) / self.rate_Hz


@dataclass(frozen=True)
class Pair:
    """doubts: what is wrong with its samples, a line each."""

    name: str
    motion: Motion
    before: Side
    after: Side
    doubts: tuple[str, ...] = ()

    @property
    def sides(self) -> tuple[Side, Side]:
        return self.before, self.after


def chosen(before: Source, after: Source, wanted: Sequence[Wanted]) -> list[Wanted]:
    """Those that the user names, else all that both files have with a unit of motion. UsageError
    where there is none, or more than a page can show."""
    if wanted:
        _check_once(before, wanted)
        return list(wanted)
    found = [
        Wanted(name, name)
        for name, scale in before.scales.items()
        if scale is not None and after.scales.get(name) is not None
    ]
    if not found:
        raise UsageError(
            f"no channel with a known unit is in both files; {_has(before)}; {_has(after)}; name "
            "one: --channel NAME:UNIT, or BEFORE=AFTER:UNIT where the names differ"
        )
    if len(found) > MOST_CHANNELS:
        names = ", ".join(one.before for one in found)
        raise UsageError(
            f"{len(found)} channels are in both files; name up to {MOST_CHANNELS} with --channel: "
            f"{names}"
        )
    return found


def _check_once(before: Source, wanted: Sequence[Wanted]) -> None:
    names = [before.known(one.before) for one in wanted]
    twice = next((name for name in names if names.count(name) > 1), None)
    if twice is not None:
        raise UsageError(f"--channel: {twice} is named twice")


def _has(source: Source) -> str:
    names = [
        f"{name} ({scale.unit})" if scale else f"{name} (unit unknown)"
        for name, scale in source.scales.items()
    ]
    return f"{shown(source.file)} has {', '.join(names[:MOST_CHANNELS]) or 'none'}"


def left_out(before: Source, after: Source, taken: Sequence[Wanted]) -> list[str]:
    """Lines about channels that are not looked at."""
    lines = []
    for source, is_after in ((before, False), (after, True)):
        used = {source.known(one.named(is_after)) for one in taken}
        other = [name for name in source.scales if name not in used]
        if other:
            more = f" and {len(other) - MOST_NAMED} more" if len(other) > MOST_NAMED else ""
            names = ", ".join(other[:MOST_NAMED])
            lines.append(f"not looked at in {shown(source.file)}: {names}{more}")
    return lines


def pair_of(before: Source, after: Source, wanted: Wanted, option: str) -> Pair:
    """UsageError where the channel is missing, has no known unit, is no even recording, or measures
    different things in the two files."""
    scales = [
        _scale(source, wanted, is_after, option)
        for source, is_after in ((before, False), (after, True))
    ]
    if scales[0].motion is not scales[1].motion:
        raise UsageError(
            f"channel {wanted.before} is {scales[0].motion.name} in {shown(before.file)} and "
            f"{scales[1].motion.name} in {shown(after.file)}; name two that measure the same: "
            f"{option} BEFORE=AFTER"
        )
    read = [
        _even(source, source.known(wanted.named(is_after)), scale)
        for source, is_after, scale in zip((before, after), (False, True), scales, strict=True)
    ]
    rate_Hz = min(one.rate_Hz for one in read)
    doubts = [
        f"{side}: {line}" for side, one in zip(SIDES, read, strict=True) for line in one.doubts
    ]
    sides = []
    for side, one in zip(SIDES, read, strict=True):
        sides.append(at_rate(Side(one.start_s, one.rate_Hz, one.values), rate_Hz))
        if sides[-1].rate_Hz != one.rate_Hz:
            doubts.append(f"{side}: resampled from {one.rate_Hz:.6g} to {rate_Hz:.6g} Hz")
    return Pair(wanted.before, scales[0].motion, *sides, tuple(doubts))


def _scale(source: Source, wanted: Wanted, is_after: bool, option: str) -> Scale:
    name = source.known(wanted.named(is_after))
    scale = wanted.scale or source.scales[name]
    if scale is None:
        raise UsageError(
            f"{shown(source.file)}: the unit of channel '{name}' is unknown; state it: {option} "
            f"{name}:UNIT or {name}:FACTOR*UNIT (m/s2, g, mm/s, um ...)"
        )
    return scale


def _even(source: Source, name: str, scale: Scale) -> Even:
    time_s, values = source.samples(name)
    where = f"{shown(source.file)}, channel {name}"
    found = even(Stamps(where, time_s, values * scale.per_one))
    if found.values.min() == found.values.max():
        raise UsageError(f"{where}: all samples are the same; is the sensor connected?")
    return found


def at_rate(side: Side, rate_Hz: float) -> Side:
    """The same where the rates are one; else resampled, band-limited."""
    if abs(rate_Hz / side.rate_Hz - 1.0) < SAME_RATE:
        return side
    return _resampled(side, rate_Hz)


def _resampled(side: Side, rate_Hz: float) -> Side:
    return Side(side.start_s, rate_Hz, resample(side.values, side.rate_Hz, rate_Hz))


def together(one: Side, other: Side, name: str) -> tuple[Side, Side]:
    """Over the time that both cover, sample beside sample, to half a sample. UsageError where that
    is too short. name: of the channel, for the message."""
    rate_Hz = min(one.rate_Hz, other.rate_Hz)
    # Clocks that part by little part by samples in the end.
    one, other = _resampled(one, rate_Hz), _resampled(other, rate_Hz)
    offset = round((other.start_s - one.start_s) * rate_Hz)
    first, second = one.values[max(offset, 0) :], other.values[max(-offset, 0) :]
    count = min(len(first), len(second))
    if count < MIN_SAMPLES:
        raise UsageError(
            f"channel {name} and the reference have only {count} samples at the same time; at "
            f"least {MIN_SAMPLES} are needed"
        )
    start_s = max(one.start_s, other.start_s)
    return Side(start_s, rate_Hz, first[:count]), Side(start_s, rate_Hz, second[:count])
