"""The command that a damper file is for: its unit, and the largest that it states."""

from collections.abc import Iterator

from quiesce.damper.model_file import DamperModel

# Of [valid], the first that holds counts.
_LIMITS = {"A": ("max_current_A", "current_A"), "V": ("command_V",)}


def command_unit(damper: DamperModel) -> str:
    """ "A", or "V" of a file that is valid up to a voltage and to no current."""
    said = set(damper.valid)
    return "V" if said & set(_LIMITS["V"]) and not said & set(_LIMITS["A"]) else "A"


def largest_command(damper: DamperModel) -> float | None:
    """In the file's own unit, > 0; None where it states none."""
    return next(_stated(damper), None)


def _stated(damper: DamperModel) -> Iterator[float]:
    for key in _LIMITS[command_unit(damper)]:
        limit = damper.valid.get(key)
        values = limit if isinstance(limit, list) else [limit]
        if all(isinstance(value, int | float) for value in values) and values and max(values) > 0.0:
            yield float(max(values))


def command_kind(damper: DamperModel) -> str:
    return {"A": "current", "V": "voltage"}[command_unit(damper)]
