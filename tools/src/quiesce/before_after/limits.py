"""A file of limits, and whether a report keeps them."""

import tomllib
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from quiesce.base.errors import UsageError, one_line
from quiesce.base.nearest import listed
from quiesce.base.paths import shown
from quiesce.before_after import thirds
from quiesce.before_after.figures import Figure, Found
from quiesce.before_after.motion import scale_of
from quiesce.before_after.words import NAMES, number
from quiesce.compare.zones import NAMES as ZONES

KEYS = ("channel", "quantity", "most", "unit", "least_fall_pct", "band_Hz", "note")
ALL = "*"
ZONE, THIRD = "zone", "third_octave_rms"
QUANTITIES = (*NAMES, ZONE, THIRD)


@dataclass(frozen=True)
class Limit:
    """where: FILE, limit N. One of most (in `unit`, or a zone) and least_fall_pct is given."""

    where: str
    channel: str
    quantity: str
    most: float | str | None
    unit: str
    least_fall_pct: float | None
    band_Hz: float | None
    note: str


@dataclass(frozen=True)
class Verdict:
    """is_sure: the whole 95 % interval is on the same side; None: no interval is known."""

    channel: str
    what: str
    limit: str
    value: str
    is_kept: bool
    is_sure: bool | None
    note: str

    @property
    def word(self) -> str:
        word = "pass" if self.is_kept else "fail"
        return f"{word}, within its uncertainty" if self.is_sure is False else word


def read_limits(file: Path) -> list[Limit]:
    """UsageError with the number of the limit for whatever is wrong with one."""
    try:
        found = tomllib.loads(file.read_text(encoding="utf-8"))
    except OSError as error:
        raise UsageError(f"{shown(file)}: {error.strerror}; name a file of limits")
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise UsageError(f"{shown(file)}: not a TOML file: {one_line(error)}")
    for key in found:
        if key != "limit":
            raise UsageError(f"{shown(file)}: unknown key '{key}'; limits are tables [[limit]]")
    limits = found.get("limit")
    if not isinstance(limits, list) or not limits:
        raise UsageError(f"{shown(file)}: no [[limit]] in it")
    return [_limit(f"{shown(file)}, limit {count}", one) for count, one in enumerate(limits, 1)]


def _limit(where: str, one: Any) -> Limit:
    if not isinstance(one, dict):
        raise UsageError(f"{where}: expected a table [[limit]]")
    for key in one:
        if key not in KEYS:
            raise UsageError(f"{where}: unknown key '{key}'; {listed(key, KEYS)}")
    for key in ("channel", "quantity"):
        if not isinstance(one.get(key), str) or not one[key]:
            raise UsageError(f"{where}: {key} is missing, a text")
    quantity = one["quantity"]
    if quantity not in QUANTITIES:
        raise UsageError(f"{where}: no quantity '{quantity}'; {listed(quantity, QUANTITIES)}")
    if ("most" in one) == ("least_fall_pct" in one):
        raise UsageError(f"{where}: needs one of most and least_fall_pct")
    for key in ("unit", "note"):
        if not isinstance(one.get(key, ""), str):
            raise UsageError(f"{where}: {key} is a text")
    limit = Limit(
        where, one["channel"], quantity, _most(where, one), one.get("unit", ""),
        _number(where, one, "least_fall_pct"), _number(where, one, "band_Hz"), one.get("note", ""),
    )  # fmt: skip
    if (limit.band_Hz is not None) != (quantity == THIRD):
        raise UsageError(f"{where}: band_Hz goes with quantity {THIRD}, and that needs it")
    if quantity == ZONE and limit.least_fall_pct is not None:
        raise UsageError(f"{where}: a zone has no fall in per cent; state most, one of A, B, C")
    return limit


def _most(where: str, one: dict[str, Any]) -> float | str | None:
    if one["quantity"] != ZONE or "most" not in one:
        return _number(where, one, "most")
    if one["most"] not in tuple(ZONES[:-1]):
        raise UsageError(f"{where}: most of a zone is one of A, B, C")
    return str(one["most"])


def _number(where: str, one: dict[str, Any], key: str) -> float | None:
    value = one.get(key)
    if value is None:
        return None
    if isinstance(value, bool) or not isinstance(value, int | float) or not abs(value) < 1e18:
        raise UsageError(f"{where}: {key} is a number")
    return float(value)


def judged(limits: Sequence[Limit], found: Sequence[Found]) -> list[Verdict]:
    """UsageError where a limit is on a channel or a figure that the report does not have."""
    return [verdict for limit in limits for verdict in _verdicts(limit, found)]


def _verdicts(limit: Limit, found: Sequence[Found]) -> list[Verdict]:
    names = [one.pair.name for one in found]
    if limit.channel != ALL and limit.channel not in names:
        raise UsageError(
            f"{limit.where}: no channel '{limit.channel}'; {listed(limit.channel, names)}"
        )
    on = [one for one in found if limit.channel in (ALL, one.pair.name)]
    if limit.quantity == ZONE:
        verdicts = [_of_zone(limit, one) for one in on if one.zones is not None]
    else:
        figures = ((one, _figure(limit, one)) for one in on)
        verdicts = [_of_figure(limit, one, figure) for one, figure in figures if figure is not None]
    if not verdicts:
        raise UsageError(f"{limit.where}: {_missing(limit, on)}")
    return verdicts


def _missing(limit: Limit, on: Sequence[Found]) -> str:
    if limit.quantity in (ZONE, "zone_velocity_rms"):
        return "no zone is known; name the machine with --machine, and see the report's doubts"
    if limit.quantity == THIRD:
        there = {thirds.nominal_Hz(index) for one in on for index in one.bands}
        bands = ", ".join(f"{freq_Hz:g}" for freq_Hz in sorted(there))
        return f"no band of {limit.band_Hz:g} Hz; there are {bands}"
    there = list(dict.fromkeys(figure.quantity for one in on for figure in one.figures))
    return f"no figure {limit.quantity} here; {listed(limit.quantity, there)}"


def _figure(limit: Limit, found: Found) -> Figure | None:
    if limit.quantity != THIRD:
        return found.figure(limit.quantity)
    unit = found.pair.motion.unit
    return next(
        (
            Figure(THIRD, unit, before.value, after.value, (before, after))
            for index, (before, after) in found.bands.items()
            if thirds.nominal_Hz(index) == limit.band_Hz
        ),
        None,
    )


def _of_zone(limit: Limit, found: Found) -> Verdict:
    assert found.zones is not None
    zone = found.zones[1]
    is_kept = zone <= str(limit.most)
    return Verdict(
        found.pair.name, "zone", f"at most {limit.most}", zone, is_kept, None, limit.note
    )


def _of_figure(limit: Limit, found: Found, figure: Figure) -> Verdict:
    what = NAMES.get(figure.quantity) or f"third octave of {limit.band_Hz:g} Hz, RMS"
    fall_pct = limit.least_fall_pct
    if fall_pct is not None:
        fell_pct, ratio = 100.0 * (1.0 - figure.change), figure.ratio
        sure = None
        if ratio is not None:
            ends = (100.0 * (1.0 - ratio.low), 100.0 * (1.0 - ratio.high))
            sure = len({end >= fall_pct for end in ends}) == 1
        return Verdict(
            found.pair.name, what, f"falls by {fall_pct:g} % or more", f"{fell_pct:.1f} %",
            fell_pct >= fall_pct, sure, limit.note,
        )  # fmt: skip
    most = _in_unit_of(limit, figure)
    sure = None
    if figure.estimates is not None:
        sure = len({end <= most for end in figure.estimates[1].interval()}) == 1
    unit = f" {figure.unit}" if figure.unit else ""
    return Verdict(
        found.pair.name, what, f"at most {number(most)}{unit}", f"{number(figure.after)}{unit}",
        figure.after <= most, sure, limit.note,
    )  # fmt: skip


def _in_unit_of(limit: Limit, figure: Figure) -> float:
    assert isinstance(limit.most, float)
    own = scale_of(figure.unit)
    if own is None:
        if limit.unit not in ("", figure.unit):
            raise UsageError(f"{limit.where}: {limit.quantity} is in '{figure.unit or '1'}'")
        return limit.most
    stated = scale_of(limit.unit)
    if stated is None or stated.motion is not own.motion:
        known = ", ".join(unit.name for unit in own.motion.units.values())
        raise UsageError(f"{limit.where}: unit of {limit.quantity} is one of {known}")
    return limit.most * stated.per_one / own.per_one
