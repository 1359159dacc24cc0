"""What a channel measures: acceleration, velocity or displacement, told by its unit."""

import re
from dataclasses import dataclass

from quiesce.base.errors import UsageError
from quiesce.recording import units
from quiesce.recording.units import Unit


@dataclass(frozen=True)
class Motion:
    """One kind of motion. per_si: how many of `unit` 1 SI unit is, for pages and limits."""

    name: str
    unit: str
    per_si: float
    order: int  # times it is integrated from acceleration
    units: dict[str, Unit]


ACCELERATION = Motion(
    "acceleration", "m/s2", 1.0, 0, {**units.ACCELERATION, "um_s2": Unit("um_s2", 1e-6)}
)
VELOCITY = Motion("velocity", "mm/s", 1e3, 1, units.VELOCITY)
DISPLACEMENT = Motion("displacement", "mm", 1e3, 2, {**units.LENGTH, "nm": Unit("nm", 1e-9)})
MOTIONS = (ACCELERATION, VELOCITY, DISPLACEMENT)
UNITS = {key: unit for motion in MOTIONS for key, unit in motion.units.items()}

_FACTOR_HINT = "write NAME:UNIT or NAME:FACTOR*UNIT, such as acc:g or counts:0.0012*m/s2"


@dataclass(frozen=True)
class Scale:
    """SI value = per_one * value."""

    motion: Motion
    per_one: float
    unit: str  # as it was written


def motion_of(key: str) -> Motion:
    """key: of UNITS."""
    return next(motion for motion in MOTIONS if key in motion.units)


def scale_of(text: str) -> Scale | None:
    """Of a unit as a file or a user writes it; None where it is none of motion."""
    key = units.normal(text)
    if key not in UNITS:
        return None
    return Scale(motion_of(key), UNITS[key].scale, text.strip())


def scale_in_name(name: str) -> tuple[str, Scale | None]:
    """A column's name without the unit that it ends in, and what that unit says.

    Understood are 'acc_g', 'Acc 1 (m/s^2)', 'x [mm]', 'v/mm/s', 'a5_mm_s2'; the longest end wins:
    'v_mm_s' ends in mm/s, not in s. A name that is nothing but a unit has none.
    """
    for break_ in re.finditer(r"[_\s/.\-(\[]+", name):
        scale = scale_of(name[break_.end() :].rstrip(" )]"))
        if scale is not None and break_.start() > 0:
            return name[: break_.start()], scale
    return name, None


@dataclass(frozen=True)
class Wanted:
    """A channel as the user names it: its name in either file, and its unit where stated."""

    before: str
    after: str
    scale: Scale | None = None

    def named(self, is_after: bool) -> str:
        return self.after if is_after else self.before


def wanted(option: str, text: str) -> Wanted:
    """NAME, NAME:UNIT, NAME:FACTOR*UNIT, or BEFORE=AFTER with any of them; 'CAN:1:' is a name with
    a colon and no unit. UsageError otherwise."""
    names, colon, end = text.rpartition(":")
    scale = _stated(option, text, end) if colon and end.strip() else None
    before, equals, after = (names if colon else text).partition("=")
    if not before.strip() or (equals and not after.strip()):
        raise UsageError(f"{option} {text}: a name is missing; {_FACTOR_HINT}")
    return Wanted(before.strip(), (after if equals else before).strip(), scale)


def _stated(option: str, text: str, end: str) -> Scale:
    match = re.fullmatch(r"(?:([^*]+)\*)?([^*]+)", end)
    scale = scale_of(match[2]) if match else None
    if match is None or scale is None:
        known = ", ".join(unit.name for unit in UNITS.values())
        raise UsageError(
            f"{option} {text}: '{end}' is no unit of motion; use one of {known}; a name that has a "
            "colon itself ends in another one"
        )
    try:
        factor = float(match[1] or 1.0)
    except ValueError:
        factor = 0.0
    if not 0.0 < abs(factor) < 1e18:
        raise UsageError(f"{option} {text}: '{match[1]}' is not a factor; {_FACTOR_HINT}")
    return Scale(scale.motion, factor * scale.per_one, end.strip())
