"""The damper and the accelerometer of a new plant: files of the user's, or ones that ship."""

import re
import tomllib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from quiesce.base.errors import UsageError, one_line
from quiesce.base.nearest import listed
from quiesce.base.paths import root, shown

DAMPERS, SENSORS = "sim_hil/data/dampers", "sim_hil/data/sensors"
DAMPER_SCHEMA, SENSOR_SCHEMA = "quiesce-damper", "quiesce-sensor"
LAG_s = 0.010  # of a coil of which nothing is known
MOST_A = 20.0  # that the controller's parameters allow
ACCELERATION = "um/s2"


@dataclass(frozen=True)
class DamperPart:
    name: str
    text: str  # of its file
    max_current: float  # of the driver: A, or V where is_in_volts
    is_in_volts: bool
    current_note: str  # where that is from
    lag_s: float  # of the coil's rise
    has_own_coil: bool
    freqs_Hz: tuple[float, float] | None  # at which it was identified
    stroke_m: float | None  # that it was tested with


@dataclass(frozen=True)
class SensorPart:
    name: str
    text: str
    corner_Hz: float


def find_part(option: str, name: str, folder: str, schema: str) -> tuple[Path, str, dict[str, Any]]:
    """A path, or the name of a file that ships: file, text, data. UsageError names the option."""
    is_path = name.endswith(".toml") or "/" in name
    file = Path(name) if is_path else root() / folder / f"{name}.toml"
    if not file.is_file():
        names = sorted(one.stem for one in (root() / folder).glob("*.toml"))
        raise UsageError(f"{option} {name}: no such file, and none ships; {listed(name, names)}")
    try:
        text = file.read_text(encoding="utf-8")
        data = tomllib.loads(text)
    except (OSError, ValueError) as error:
        raise UsageError(f"{option} {shown(file)}: not a TOML file: {one_line(error)}") from None
    if data.get("schema") != schema:
        raise UsageError(f"{option} {shown(file)}: expected schema = {schema!r}")
    return file, text, data


def read_damper(name: str, max_current: float | None) -> DamperPart:
    """max_current: what the user says; None: the largest at which it was identified."""
    file, text, data = find_part("--damper", name, DAMPERS, DAMPER_SCHEMA)
    valid, coil = _table(data, "valid"), _table(data, "coil")
    is_in_volts = "command_V" in valid
    known = _range(valid, "command_V" if is_in_volts else "current_A")
    if valid.get("usable") is False:
        raise UsageError(f"--damper {name}: its file says that it is not usable "
                         f"({valid.get('reason', 'valid.usable')})")  # fmt: skip
    current, note = _max_current(name, known[1] if known else None, max_current, is_in_volts)
    amplitude_m = valid.get("amplitude_m", valid.get("stroke_m"))
    return DamperPart(
        name=str(data.get("name", file.stem)),
        text=text,
        max_current=current,
        is_in_volts=is_in_volts,
        current_note=note,
        lag_s=float(coil.get("rise_s", LAG_s)),
        has_own_coil=bool(coil),
        freqs_Hz=_range(valid, "freq_Hz"),
        stroke_m=float(amplitude_m) if isinstance(amplitude_m, (int, float)) else None,
    )


def _max_current(
    name: str, known: float | None, asked: float | None, is_in_volts: bool
) -> tuple[float, str]:
    unit = "V" if is_in_volts else "A"
    if asked is None and not known:
        raise UsageError(
            f"--damper {name}: its file says of no current above 0 that it holds there (valid."
            "current_A); name the driver's largest, --max-current A"
        )
    if asked is not None and known and asked > known * (1.0 + 1e-9):
        raise UsageError(
            f"--max-current {asked:g}: the damper was identified up to {known:g} {unit} only"
        )
    largest = known if asked is None else asked
    assert largest is not None
    if largest > MOST_A:
        raise UsageError(f"--max-current: {largest:g} {unit}; the controller commands at most "
                         f"{MOST_A:g}: name less")  # fmt: skip
    source = "--max-current" if asked is not None else "the largest at which it was identified"
    return largest, source


def _table(data: dict[str, Any], key: str) -> dict[str, Any]:
    value = data.get(key, {})
    return value if isinstance(value, dict) else {}


def _range(table: dict[str, Any], key: str) -> tuple[float, float] | None:
    value = table.get(key)
    ends = value if isinstance(value, list) else [value]
    numbers = [float(one) for one in ends if isinstance(one, (int, float))]
    return (min(numbers), max(numbers)) if numbers else None


def read_sensor(name: str) -> SensorPart:
    """UsageError where it measures no acceleration."""
    file, text, data = find_part("--accel", name, SENSORS, SENSOR_SCHEMA)
    if data.get("unit") != ACCELERATION:
        raise UsageError(
            f"--accel {name}: measures in {data.get('unit')}; an accelerometer's unit is "
            f"{ACCELERATION}"
        )
    corner = data.get("corner_Hz", 0.0)
    return SensorPart(
        str(data.get("name", file.stem)),
        _without_cross_talk(text),
        float(corner) if isinstance(corner, (int, float)) else 0.0,
    )


def _without_cross_talk(text: str) -> str:
    """Of what is elsewhere, which a plant has to name: the line stays as a comment."""
    return re.sub(
        r"^(cross_talk_pct\b.*)$", r"# \1  (needs cross_talk_from in the plant)", text, flags=re.M
    )
