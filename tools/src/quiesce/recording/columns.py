"""Which column is what: found by name where the header leaves no doubt, else as the user says."""

from dataclasses import dataclass
from types import MappingProxyType

import numpy as np

from quiesce.base.errors import Problems, UsageError
from quiesce.recording import units
from quiesce.recording.table import Table, at, clipped
from quiesce.recording.units import Unit


@dataclass(frozen=True)
class Role:
    units: dict[str, Unit]
    stems: frozenset[str]  # names, without their unit, that mean this and nothing else
    hint: str  # a column as the option takes it


def _role(known: dict[str, Unit], stems: str, hint: str) -> Role:
    return Role(known, frozenset(stems.split()), hint)


ROLES = MappingProxyType(
    {
        "time": _role(units.TIME, "t time elapsed elapsed_time timestamp", "t:s"),
        "displacement": _role(
            units.LENGTH, "x d disp displacement stroke pos position travel", "x:mm"
        ),
        "velocity": _role(units.VELOCITY, "v vel velocity speed xdot", "v:mm/s"),
        "acceleration": _role(units.ACCELERATION, "a acc accel acceleration xddot", "acc:m/s2"),
        "force": _role(units.FORCE, "f force load", "f:N"),
        "current": _role(units.CURRENT, "i current coil_current coil curr current_cmd", "i:A"),
        "command": _role(
            units.VOLTAGE, "coil coil_voltage voltage volt command u cmd", "coil_voltage:V"
        ),
        "temperature": _role(units.TEMPERATURE, "temp temperature", "temp:C"),
        "drive": _role(units.VOLTAGE, "drive", "drive:V"),
    }
)
NONE = "none"
# Of recordings of dampers; the others are of structures.
OF_DAMPERS = tuple(role for role in ROLES if role != "drive")


@dataclass(frozen=True)
class ColumnSpec:
    """A column as the user names it; the unit comes from its name where none is stated."""

    name: str
    unit: str | None = None
    factor: float = 1.0


@dataclass(frozen=True)
class Column:
    """SI value = scale * cell + offset."""

    role: str
    name: str
    unit: Unit
    factor: float = 1.0

    def si(self, cells: np.ndarray) -> np.ndarray:
        return cells * (self.factor * self.unit.scale) + self.unit.offset

    def __str__(self) -> str:
        scaled = "" if self.factor == 1.0 else f"{self.factor:g} "
        return f"{self.role} = {clipped(self.name)} ({scaled}{self.unit.name})"


def parse_spec(role: str, text: str) -> ColumnSpec:
    """NAME, NAME:UNIT or NAME:FACTOR*UNIT. UsageError for a unit that `role` does not have."""
    name, colon, end = text.rpartition(":")
    if not colon:
        return ColumnSpec(text.strip())
    factor, star, unit = end.rpartition("*")
    try:
        scale = float(factor) if star else 1.0
    except ValueError:
        scale = np.nan
    if not (np.isfinite(scale) and scale != 0.0):
        raise UsageError(
            f"--{role} '{clipped(text)}': '{clipped(factor)}' is not a factor; "
            f"write NAME:UNIT or NAME:FACTOR*UNIT, such as {ROLES[role].hint}"
        )
    spec = ColumnSpec(name.strip(), unit.strip(), scale)
    stated_unit(role, spec)
    return spec


def stated_unit(role: str, spec: ColumnSpec) -> Unit | None:
    if spec.unit is None:
        return None
    unit = ROLES[role].units.get(units.normal(spec.unit))
    if unit is None:
        raise UsageError(
            f"'{clipped(spec.unit)}' is no unit of {role} that is known; use one of "
            f"{units.names(ROLES[role].units)}, or NAME:FACTOR*UNIT"
        )
    return unit


def named_column(table: Table, role: str, spec: ColumnSpec) -> Column:
    """The column that the user names, with its unit. UsageError without one of them."""
    table.index(spec.name)
    unit = stated_unit(role, spec) or units.split_name(spec.name, ROLES[role].units)[1]
    if unit is None:
        raise at(
            table.file, table.head_line,
            f"column '{clipped(spec.name)}' ends in no unit of {role}; state it: "
            f"--{role} '{clipped(spec.name)}:UNIT' with one of {units.names(ROLES[role].units)}",
        )  # fmt: skip
    return Column(role, spec.name, unit, spec.factor)


def likely_names(table: Table, role: str) -> list[str]:
    """Headers whose name without the unit is one of the role's, those with a unit first."""
    parts = {name: units.split_name(name, ROLES[role].units) for name in table.head if name}
    fitting = {name: unit for name, (stem, unit) in parts.items() if stem in ROLES[role].stems}
    return [name for name, unit in fitting.items() if unit] or list(fitting)


def find_column(table: Table, role: str, needed: bool) -> Column | None:
    """The only column that can be meant. UsageError where a needed one is missing or in doubt."""
    names = likely_names(table, role)
    if len(names) == 1:
        unit = units.split_name(names[0], ROLES[role].units)[1]
        if unit or needed:
            return named_column(table, role, ColumnSpec(names[0]))
    if not needed:
        return None
    doubt = f"more than one column could be the {role}: {', '.join(map(clipped, names))}"
    raise at(
        table.file, table.head_line,
        f"{doubt if names else f'no column is clearly the {role}'}; name it with --{role} "
        f"NAME:UNIT (such as {ROLES[role].hint}); there are: {table.headers}",
    )  # fmt: skip


def column_of(
    table: Table, role: str, given: dict[str, ColumnSpec | None], needed: bool
) -> Column | None:
    if role not in given:
        return find_column(table, role, needed)
    spec = given[role]
    return named_column(table, role, spec) if spec is not None else None


def motion_column(table: Table) -> dict[str, Column]:
    """A column whose name has no unit is taken for the motion only here, to ask for its unit."""
    column = find_column(table, "displacement", needed=not likely_names(table, "velocity"))
    column = column or find_column(table, "velocity", needed=True)
    return {column.role: column} if column is not None else {}


def find_columns(table: Table, given: dict[str, ColumnSpec | None]) -> dict[str, Column]:
    """Columns by role. A role given as None is not looked for; motion is needed in some form.
    UsageError with all that is unclear about them.

    Time is needed unless given as None, force always; a current wins over a voltage.
    """
    found: dict[str, Column] = {}
    problems = Problems()
    for role in OF_DAMPERS:
        with problems.told():
            if (column := column_of(table, role, given, role in ("time", "force"))) is not None:
                found[role] = column
    with problems.told():
        if not any(role in found or given.get(role) for role in ("displacement", "velocity")):
            found |= motion_column(table)
    problems.refuse()
    if "current" in found and "command" in found:
        drop_one_command(table, found, given)
    return found


def drop_one_command(
    table: Table, found: dict[str, Column], given: dict[str, ColumnSpec | None]
) -> None:
    if given.get("current") and given.get("command"):
        raise at(
            table.file, table.head_line,
            "both a current and a voltage are named; a model has one command: name the current "
            "where it was measured, else the voltage",
        )  # fmt: skip
    del found["current" if given.get("command") else "command"]
