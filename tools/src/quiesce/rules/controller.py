"""A rule file as what a running controller takes: its rules where plain tables hold them, else the
surface of what they answer."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from quiesce.base.errors import UsageError
from quiesce.base.paths import shown
from quiesce.rules.formats.build import NotPlain
from quiesce.rules.formats.files import read_rules, read_system
from quiesce.rules.integers.compiled import CompiledBase
from quiesce.rules.integers.controller import INPUT_LSB, OUTPUT_LSB, compile_for_controller
from quiesce.rules.integers.table import table_words
from quiesce.rules.surface.compile import Surface, compile_surface
from quiesce.table.words import require_room

MOST_ERROR_PCT = 1.0  # of an output's range, unless the user takes more


@dataclass(frozen=True)
class ControllerTable:
    """notes: what the user should know of it, a line each."""

    words: list[int]
    notes: Sequence[str]


def controller_table(file: Path) -> ControllerTable:
    """UsageError, in one line, where the file is none or the controller does not take it."""
    found, reason = controller_form(file)
    if isinstance(found, CompiledBase):
        words = table_words(found)
        try:
            require_room(len(words))
        except ValueError as error:
            raise UsageError(f"{shown(file)}: {error}")
        return ControllerTable(words, found.notes)
    require_near(file, found, MOST_ERROR_PCT)
    return ControllerTable(list(found.words), [reason, *found.scaled.notes, error_text(found)])


def controller_form(
    file: Path, approximate: int | None = None, defaults: Mapping[str, float] | None = None
) -> tuple[CompiledBase | Surface, str]:
    """The rules themselves, or their surface and why. approximate: smooth sets as chains of so many
    segments; then no surface. UsageError as controller_table."""
    try:
        return compile_for_controller(read_rules(file, approximate), defaults), ""
    except NotPlain as reason:
        if approximate is not None:
            raise
        system = read_system(file)
        surface = compile_surface(system, INPUT_LSB, OUTPUT_LSB[0], defaults)
        rows, columns = surface.nodes
        return surface, f"{reason}; taken: the surface of its answers, {rows} x {columns} values"


def require_near(file: Path, surface: Surface, most_pct: float) -> None:
    """UsageError where it is farther off than most_pct of the output's range."""
    found_pct = 100.0 * surface.error
    if found_pct > most_pct:
        places = zip(surface.scaled.system.inputs, surface.worst_at, strict=True)
        where = ", ".join(f"{one.name} {x:.4g}" for one, x in places)
        raise UsageError(
            f"{shown(file)}: its surface is up to {found_pct:.2g} % of the output's range off, at "
            f"{where}: the rules jump or bend more than a controller's table can follow; "
            f"--max-error {math.ceil(found_pct)} of 'quiesce rules compile --controller' takes it "
            "as it is"
        )


def error_text(surface: Surface) -> str:
    return f"its surface is up to {100.0 * surface.error:.2g} % of the output's range off"
