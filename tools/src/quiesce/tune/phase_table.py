"""Law files of the phase law (*.phase.toml).

A law has two settings, each a table of pulses over frequency. In a period of 180 degrees of the
displacement's phase (x ~ cos), the command is level_mA within width_deg around centre_deg, else
floor_mA. Between points the firmware interpolates all four linearly, the centre the shorter way
round; outside the first and last point it uses those.
"""

import tomllib
from collections.abc import Sequence
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

from quiesce.base.errors import UsageError, one_line
from quiesce.base.paths import shown

SCHEMA = "quiesce-phase-law"
VERSION = 1
SETTINGS = ("displacement", "balanced")
FEWEST_POINTS, MOST_POINTS = 2, 64
MOST_MA = 65_000


@dataclass(frozen=True)
class Point:
    """A pulse at one frequency."""

    freq_Hz: float  # 0.001 .. 65.535
    centre_deg: float  # 0 .. below 180
    width_deg: float  # 0 .. 180; 180: level throughout
    level_mA: int
    floor_mA: int  # 0 .. level_mA
    # Where the firmware adapts the pulse: what RMS acceleration counts against displacement, once
    # RMS acceleration / (half peak-to-peak displacement x (2 pi f)^2) is above accel_shape.
    accel_weight: float = 0.0
    accel_shape: float = 0.0  # 0 .. below 4; 0.707 is a sine
    ramp_deg: float = 0.0  # how long each edge takes, about its middle; below 90


@dataclass(frozen=True)
class PhaseLaw:
    name: str
    source: str  # how it was made
    unlock_current_mA: int  # while the phase is not known
    settings: dict[str, tuple[Point, ...]]  # by name, all of SETTINGS


ALLOWED = {
    "freq_Hz": (0.001, 65.535, "Hz"),
    "centre_deg": (0.0, 179.9999, "degrees"),
    "width_deg": (0.0, 180.0, "degrees"),
    "level_mA": (0, MOST_MA, "mA"),
    "floor_mA": (0, MOST_MA, "mA"),
    "accel_weight": (0.0, 255.0, ""),
    "accel_shape": (0.0, 3.9999, ""),
    "ramp_deg": (0.0, 89.99, "degrees"),
}


class _Reader:
    """Checks one file; every complaint names the file, the key, what is wrong, what is allowed."""

    def __init__(self, file: Path) -> None:
        self._file = file

    def fail(self, key: str, what: str, allowed: str) -> UsageError:
        return UsageError(f"{shown(self._file)}: {key}: {what}; allowed: {allowed}")

    def data(self) -> dict[str, Any]:
        try:
            return tomllib.loads(self._file.read_text(encoding="utf-8"))
        except OSError as error:
            raise UsageError(f"{shown(self._file)}: {error.strerror}; name a law file")
        except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
            raise UsageError(f"{shown(self._file)}: not a TOML file: {one_line(error)}")

    def known(
        self, table: Any, keys: Sequence[str], key: str, optional: Sequence[str] = ()
    ) -> dict[str, Any]:
        """The table, with each of the keys that is not optional, and no other."""
        if not isinstance(table, dict):
            raise self.fail(key, "not a table", f"a table of {', '.join(keys)}")
        inside = f"{key}." if key else ""
        for name in table:
            if name not in keys:
                raise self.fail(f"{inside}{name}", "unknown key", ", ".join(keys))
        for name in keys:
            if name not in table and name not in optional:
                raise self.fail(f"{inside}{name}", "missing", "it must be given")
        return table

    def exactly(self, value: Any, expected: object, key: str) -> None:
        if value != expected or type(value) is not type(expected):
            raise self.fail(key, f"{value!r}", f"{expected!r}")

    def text(self, value: Any, key: str) -> str:
        if not isinstance(value, str) or not value:
            raise self.fail(key, f"{value!r}", "a text that is not empty")
        return value

    def number(self, value: Any, key: str, least: float, most: float, unit: str) -> float:
        whole = isinstance(least, int)
        allowed = f"{'an integer, ' if whole else ''}{least:g} .. {most:g} {unit}".rstrip()
        kinds = int if whole else (int, float)
        if isinstance(value, bool) or not isinstance(value, kinds) or not least <= value <= most:
            raise self.fail(key, f"{value!r}", allowed)
        return value if whole else float(value)

    def point(self, table: Any, key: str) -> Point:
        names = [field.name for field in fields(Point)]
        defaults = {"accel_weight": 0.0, "accel_shape": 0.0, "ramp_deg": 0.0}
        table = {**defaults, **self.known(table, names, key, tuple(defaults))}
        point = Point(*(self.number(table[n], f"{key}.{n}", *ALLOWED[n]) for n in names))
        if point.floor_mA > point.level_mA:
            raise self.fail(f"{key}.floor_mA", f"{point.floor_mA}", f"0 .. {point.level_mA} mA")
        return point

    def points(self, value: Any, key: str) -> tuple[Point, ...]:
        if not isinstance(value, list) or not FEWEST_POINTS <= len(value) <= MOST_POINTS:
            what = f"{len(value)} points" if isinstance(value, list) else "not an array"
            raise self.fail(key, what, f"{FEWEST_POINTS} .. {MOST_POINTS} points")
        points = tuple(self.point(each, f"{key}[{i}]") for i, each in enumerate(value))
        for i in range(1, len(points)):
            before, after = points[i - 1].freq_Hz, points[i].freq_Hz
            if round(1e3 * after) <= round(1e3 * before):
                wrong = f"{after:g} Hz after {before:g} Hz"
                raise self.fail(f"{key}[{i}].freq_Hz", wrong, "rising by 0.001 Hz or more")
        return points

    def settings(self, value: Any) -> dict[str, tuple[Point, ...]]:
        if not isinstance(value, list) or len(value) != len(SETTINGS):
            what = f"{len(value)} tables" if isinstance(value, list) else "not an array of tables"
            raise self.fail("setting", what, f"two: {', then '.join(SETTINGS)}")
        out = {}
        for i, expected in enumerate(SETTINGS):
            table = self.known(value[i], ("name", "points"), f"setting[{i}]")
            self.exactly(table["name"], expected, f"setting[{i}].name")
            out[expected] = self.points(table["points"], f"setting[{i}].points")
        return out


def read_law(file: Path) -> PhaseLaw:
    """UsageError naming file, key, what is wrong and what is allowed."""
    reader = _Reader(file)
    keys = ("schema", "version", "name", "source", "unlock_current_mA", "setting")
    data = reader.known(reader.data(), keys, "")
    reader.exactly(data["schema"], SCHEMA, "schema")
    reader.exactly(data["version"], VERSION, "version")
    unlock_mA = reader.number(data["unlock_current_mA"], keys[4], *ALLOWED["level_mA"])
    return PhaseLaw(
        reader.text(data["name"], "name"),
        reader.text(data["source"], "source"),
        int(unlock_mA),
        reader.settings(data["setting"]),
    )


def law_text(law: PhaseLaw) -> str:
    """The law as a law file, one point a line."""
    quoted = _toml_text
    lines = [
        f"schema = {quoted(SCHEMA)}",
        f"version = {VERSION}",
        f"name = {quoted(law.name)}",
        f"source = {quoted(law.source)}",
        f"unlock_current_mA = {law.unlock_current_mA}",
    ]
    for name in SETTINGS:
        lines += ["", "[[setting]]", f"name = {quoted(name)}", "points = ["]
        lines += [f"    {_point_text(point)}," for point in law.settings[name]]
        lines.append("]")
    return "\n".join(lines) + "\n"


def _toml_text(text: str) -> str:
    escaped = text.replace("\\", "\\\\").replace('"', '\\"')
    return '"' + " ".join(escaped.split()) + '"'


def _point_text(point: Point) -> str:
    return (
        f"{{ freq_Hz = {point.freq_Hz:.3f}, centre_deg = {point.centre_deg:.2f}, "
        f"width_deg = {point.width_deg:.2f}, level_mA = {point.level_mA}, "
        f"floor_mA = {point.floor_mA}, accel_weight = {point.accel_weight:.3f}, "
        f"accel_shape = {point.accel_shape:.4f}, ramp_deg = {point.ramp_deg:.2f} }}"
    )


def interpolated(points: Sequence[Point], freq_Hz: float) -> Point:
    """The pulse between points, as the firmware interpolates it (but without its rounding)."""
    if freq_Hz <= points[0].freq_Hz:
        return points[0]
    for low, high in zip(points, points[1:], strict=False):
        if freq_Hz <= high.freq_Hz:
            return _between(low, high, freq_Hz)
    return points[-1]


def _between(low: Point, high: Point, freq_Hz: float) -> Point:
    part = (freq_Hz - low.freq_Hz) / (high.freq_Hz - low.freq_Hz)
    turn = (high.centre_deg - low.centre_deg + 90.0) % 180.0 - 90.0
    return Point(
        freq_Hz,
        (low.centre_deg + part * turn) % 180.0,
        low.width_deg + part * (high.width_deg - low.width_deg),
        round(low.level_mA + part * (high.level_mA - low.level_mA)),
        round(low.floor_mA + part * (high.floor_mA - low.floor_mA)),
        low.accel_weight + part * (high.accel_weight - low.accel_weight),
        low.accel_shape + part * (high.accel_shape - low.accel_shape),
        low.ramp_deg + part * (high.ramp_deg - low.ramp_deg),
    )
