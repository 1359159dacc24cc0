"""From a case to a run of the bench: its files as the case changes them, and its options."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from quiesce.base.errors import UsageError
from quiesce.base.named_files import whole
from quiesce.base.nearest import listed
from quiesce.campaign.design import Case
from quiesce.campaign.documents import Documents, with_change
from quiesce.campaign.factors import SET, Assignment

LAW, SEED = "law", "seed"
SCENARIO, PLANT, BOARD = "scenario", "plant", "board"
PARAMETER = "parameter"
# Files of tables, and the bench's options for them.
TABLES = {
    "law_table": "law-table",
    "force_map": "force-map",
    "rules": "rules",
    "pulses": "pulses",
}
FILES = (SCENARIO, PLANT, BOARD)
ROOTS = (LAW, SEED, *FILES, *TABLES, PARAMETER)


@dataclass
class Parts:
    """What a run is made of; files by name or, where a case changed them, by content."""

    scenario: Any
    options: dict[str, str] = field(default_factory=dict)
    settings: dict[str, str] = field(default_factory=dict)


@dataclass(frozen=True)
class Recipe:
    """All that a worker needs to run any case. base: what holds for all of them, a value a key."""

    base: Mapping[str, Any]
    documents: Documents
    figures: tuple[str, ...]

    def parts(self, case: Case) -> Parts:
        """UsageError where the case asks for what is not there."""
        parts = Parts(self.base[SCENARIO])
        parts.options[SEED] = str(case.seed)
        own = [Assignment(key, value) for key, value in self.base.items() if key != SCENARIO]
        drawn = [one for level in case.levels for one in level.sets]
        # A file before what is in it.
        for one in sorted(
            [*own, *drawn], key=lambda one: (one.key != SCENARIO, one.key.count("."))
        ):
            self._assign(parts, one)
        if LAW not in parts.options:
            raise UsageError(f'{LAW}: the case has none; say {LAW} = "off" in the campaign')
        return parts

    def _assign(self, parts: Parts, one: Assignment) -> None:
        root, *rest = one.key.split(".")
        if root == PARAMETER:
            parts.settings[".".join(rest)] = text_of(one.value)
        elif root in FILES:
            path = rest if root == SCENARIO else [root, *rest]
            parts.scenario = with_change(parts.scenario, path, one.changed, self.documents)
        else:
            option = TABLES.get(root, root)
            parts.options[option] = text_of(one.value)


def text_of(value: Any) -> str:
    """As the bench's options have it: parameters are switched by on and off."""
    return ("off", "on")[value] if isinstance(value, bool) else str(value)


def require_key(key: str, how: str, place: str) -> None:
    """UsageError where a campaign cannot set this."""
    root, *rest = key.split(".")
    if root not in ROOTS or "" in rest:
        raise UsageError(f"{place}: no key '{key}'; it begins with {listed(root, ROOTS)}")
    is_whole = not rest
    if root == PARAMETER and len(rest) != 1:
        raise UsageError(f"{place}: expected parameter.NAME; 'quiesce params' lists all")
    if root in (LAW, SEED, *TABLES) and not is_whole:
        raise UsageError(f"{place}: {root} has no parts")
    if how != SET and (is_whole or root == PARAMETER):
        raise UsageError(f"{place}: only numbers in a file can be changed by {how}")


def require_file(key: str, value: Any, folder: Path, place: str) -> Any:
    """The value with whole paths; UsageError where the key wants a file that is not there."""
    found = whole(value, folder)
    if key in (*FILES, *TABLES) and (not isinstance(value, str) or not found.startswith("/")):
        raise UsageError(f"{place}: there is no file {value}, from the folder of the campaign")
    return found
