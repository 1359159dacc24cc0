"""What somebody wants to have commissioned, as he said it and as it stands in the folder's file."""

from dataclasses import asdict, dataclass, fields
from typing import Any, get_args, get_origin, get_type_hints

from quiesce.base.errors import UsageError

# The band that is swept where nothing is said. Dwells follow from the first mode.
BAND_Hz = (1.0, 100.0)


@dataclass(frozen=True)
class Wants:
    """Places of files are whole paths. None: what the plant of --sim has."""

    plant: str | None = None  # simulated; None: on a bus
    start: tuple[str, ...] = ()  # NAME=VALUE of the simulated controller
    base_plant: str | None = None
    damper: str | None = None  # a file; None: the one that is found
    modal_mass_kg: float = 1.0
    is_damper_elsewhere: bool = False
    mode_count: int | None = None
    max_current_A: float | None = None
    drive_V: float | None = None
    band_Hz: tuple[float, float] = BAND_Hz
    first_mode_Hz: float | None = None
    is_as_mounted: bool = False  # the accelerometer is not turned over
    setting: str = "balanced"
    is_quick: bool = False

    def data(self) -> dict[str, Any]:
        """As JSON has it."""
        return {
            name: list(value) if isinstance(value, tuple) else value
            for name, value in asdict(self).items()
        }


def wants_of(data: dict[str, Any]) -> Wants:
    """UsageError where the file says what nobody could have wanted."""
    said = {name: tuple(one) if isinstance(one, list) else one for name, one in data.items()}
    hints = get_type_hints(Wants)
    if set(said) != set(hints) or not all(fits(said[name], hints[name]) for name in hints):
        raise UsageError("what was wanted is not whole; --fresh begins anew")
    return Wants(**said)


def fits(value: object, hint: Any) -> bool:
    """Whether it is of that kind: of Wants."""
    if get_origin(hint) is tuple:
        kinds = get_args(hint)
        has_length = kinds[-1] is Ellipsis or (
            isinstance(value, tuple) and len(value) == len(kinds)
        )
        return isinstance(value, tuple) and has_length and all(fits(one, kinds[0]) for one in value)
    kinds = get_args(hint) or (hint,)
    if isinstance(value, bool):
        return bool in kinds
    return isinstance(value, kinds) or (float in kinds and isinstance(value, int))


def same(before: Wants, now: Wants) -> None:
    """UsageError, naming what differs: results of the steps that are done hold for what was
    wanted then."""
    for one in fields(Wants):
        if getattr(before, one.name) != getattr(now, one.name):
            raise UsageError(
                f"this folder was begun with {one.name} = {getattr(before, one.name)!r}, now it is "
                f"{getattr(now, one.name)!r}; --from STEP goes back, --fresh begins anew"
            )
