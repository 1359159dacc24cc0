"""The file beside a recording that says which column is what, for every command that reads it.

`rig.csv.columns.toml` beside `rig.csv` is proposed where names alone leave something in doubt; the
user corrects it, and it is used from then on.
"""

import re
import sys
import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from quiesce.base.errors import Problems, UsageError, one_line
from quiesce.base.paths import shown
from quiesce.recording import units
from quiesce.recording.columns import NONE, ROLES, ColumnSpec, parse_spec, stated_unit
from quiesce.recording.table import Table, clipped

SUFFIX = ".columns.toml"
UNKNOWN = "?"  # in place of a unit that the user has to state
# What a column may be called, in English and German, as words begin.
_WORDS = {
    "time": "time zeit",
    "displacement": "displacement disp stroke travel position weg hub auslenkung verschiebung",
    "velocity": "velocity speed geschwindigkeit",
    "acceleration": "acceleration accel beschleunigung",
    "force": "force load kraft last",
    "current": "current strom",
    "command": "voltage spannung",
    "temperature": "temperature temp temperatur",
    "drive": "drive excitation anregung erregung",
}


def is_number(value: Any) -> bool:
    """Finite as a float; an integer may have any length."""
    is_real = isinstance(value, int | float) and not isinstance(value, bool)
    return is_real and abs(value) <= sys.float_info.max


def file_beside(file: Path) -> Path:
    return file.with_name(file.name + SUFFIX)


def stated_beside(file: Path) -> dict[str, ColumnSpec | None]:
    """By role; nothing where there is no such file. UsageError, in one line, for what is wrong."""
    place = file_beside(file)
    try:
        table = tomllib.loads(place.read_text(encoding="utf-8"))
    except FileNotFoundError:
        return {}
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or one_line(error)
        raise UsageError(f"{shown(place)}: {clipped(reason, 200)}; repair or delete it")
    if set(table) - {"columns"}:
        raise UsageError(f"{shown(place)}: it has one table, [columns], and nothing else")
    columns = table.get("columns", {})
    for role, text in columns.items() if isinstance(columns, Mapping) else ():
        if isinstance(text, str) and text.endswith(f":{UNKNOWN}"):
            raise UsageError(
                f"{shown(place)}: {role}: the unit of '{clipped(text[:-2])}' is open; write one of "
                f"{units.names(ROLES[role].units) if role in ROLES else 'its units'} for {UNKNOWN}"
            )
    return given_columns(columns, shown(place))


def proposed(table: Table, error: UsageError, missing: str | None = None) -> UsageError:
    """The error, and where a proposal for the columns is now; the error alone where nothing can be
    proposed (for the missing role, where one is named), or cannot be written there, or the user has
    such a file."""
    place = file_beside(table.file)
    lines = _lines(table)
    known = {role for role, unit in map(_guess, table.head) if unit}
    if not lines or place.exists() or (missing is not None and missing not in known):
        return error
    try:
        place.write_text("\n".join([*_head(table), *lines, ""]), encoding="utf-8")
    except OSError:
        return error
    return UsageError(
        f"{error}; or correct {shown(place)}, which now has a proposal, and run this again"
    )


def _head(table: Table) -> list[str]:
    return [
        f"# Which column of {table.file.name} is what: a proposal. Correct it; quiesce reads it",
        '# with the file from now on. role = "COLUMN:UNIT", "COLUMN:FACTOR*UNIT" or "none"',
        f"# roles: {', '.join(ROLES)}",
        "[columns]",
    ]


def _lines(table: Table) -> list[str]:
    """Each role once; a second column for it, and one of no role, as a comment."""
    lines: list[str] = []
    taken: set[str] = set()
    for name in filter(None, table.head):
        role, unit = _guess(name)
        if role is None:
            lines.append(f"# not understood: {_quoted(name)}")
            continue
        mark = "# or: " if role in taken else ""
        taken.add(role)
        lines.append(f"{mark}{role} = {_quoted(f'{name}:{unit or UNKNOWN}')}")
    return lines if taken else []


def _guess(name: str) -> tuple[str | None, str]:
    """Role and unit that a column's name speaks of; the unit is empty where none is understood."""
    words = re.findall(r"[^\W\d_]+", name.lower())
    for role, known in _WORDS.items():
        if any(word.startswith(tuple(known.split())) for word in words):
            return role, _unit_in(name, ROLES[role].units)
    for role in ROLES:
        stem, unit = units.split_name(name, ROLES[role].units)
        if stem in ROLES[role].stems:
            return role, unit.name if unit else ""
    return None, ""


def _unit_in(name: str, known: Mapping[str, units.Unit]) -> str:
    """'Kraft in N', 'Weg (mm)', 'Beschleunigung [m/s^2]', 'force_N'."""
    said = re.search(r"\bin\s+(\S+)\s*$", name)
    unit = known.get(units.normal(said[1])) if said else units.split_name(name, dict(known))[1]
    return unit.name if unit else ""


def _quoted(text: str) -> str:
    """As a basic string of TOML."""
    escaped = text.replace("\\", "\\\\").replace('"', '\\"')
    return '"' + "".join(c if c.isprintable() else f"\\u{ord(c):04x}" for c in escaped) + '"'


def given_columns(table: Any, where: str) -> dict[str, ColumnSpec | None]:
    """From { role = "NAME[:UNIT]" } or { role = { column, unit, scale } }; "none" for none."""
    if not isinstance(table, Mapping):
        raise UsageError(f"{where}: columns has to be a table, such as {{ force = 'f:N' }}")
    given: dict[str, ColumnSpec | None] = {}
    problems = Problems()
    for role, value in table.items():
        with problems.told():
            if role not in ROLES:
                raise UsageError(
                    f"{where}: columns: no role '{clipped(role)}'; known are {', '.join(ROLES)}"
                )
            given[role] = column_spec(role, value, where)
    problems.refuse()
    return given


def column_spec(role: str, value: Any, where: str) -> ColumnSpec | None:
    if isinstance(value, str) and value:
        return None if value == NONE else parse_spec(role, value)
    is_table = isinstance(value, Mapping) and "column" in value
    if not is_table or not set(value) <= {"column", "unit", "scale"}:
        raise UsageError(
            f"{where}: columns: {role} has to be 'NAME', 'NAME:UNIT' or "
            "{ column = 'NAME', unit = 'UNIT', scale = 1.0 }"
        )
    spec = ColumnSpec(value["column"], value.get("unit"), value.get("scale", 1.0))
    texts = (spec.name, spec.unit if spec.unit is not None else "")
    if not all(isinstance(text, str) for text in texts) or not is_number(spec.factor):
        raise UsageError(f"{where}: columns: {role}: names and units are texts, scale is a number")
    if spec.factor == 0:
        raise UsageError(f"{where}: columns: {role}: a scale of 0 leaves nothing")
    stated_unit(role, spec)
    return spec
