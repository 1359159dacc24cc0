"""Laws to compare that are made for each structure: NAME[:key=value,...] of `quiesce law list`."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from quiesce.base.errors import UsageError
from quiesce.compare.laws import LABEL, ComparedLaw
from quiesce.engine.bench import setting_options
from quiesce.engine.params import parameters
from quiesce.law.recipe import Recipe, make, values_of
from quiesce.law.recipes import find
from quiesce.law.rig import LawRig
from quiesce.table.file import SUFFIX, table_bytes

MAP, TRACKER, MAPPED = "map", "tracker", "inverse"


@dataclass(frozen=True)
class RecipeLaw:
    """settings: words of the recipe; parameters: words of the controller."""

    text: str
    label: str
    recipe: Recipe
    settings: tuple[str, ...]
    parameters: tuple[str, ...]
    map_file: Path | None

    def law(self, rig: LawRig, folder: Path) -> ComparedLaw:
        """Its table is a file of this folder. UsageError where the rig does not allow it."""
        made = make(self.recipe, rig, values_of(self.recipe, self.settings))
        file = folder / f"{len(list(folder.iterdir()))}{SUFFIX}"
        file.write_bytes(table_bytes(made.table.words(), rig.board_crc32))
        of_map = () if self.map_file is None else ("--force-map", str(self.map_file))
        options = ("--law-table", str(file), *of_map, *setting_options(self.parameters))
        return ComparedLaw(self.label, made.table.law, options)


def read_recipe(text: str) -> RecipeLaw:
    """UsageError, in one line, where the words do not name a recipe and what it takes."""
    name, _, rest = text.partition(":")
    recipe = find(name)
    known = {one.name for one in recipe.settings}
    controller = {one["name"] for one in parameters()}
    label, map_file = text if rest else name, None
    settings: list[str] = []
    found: list[str] = []
    for word in filter(None, rest.split(",")):
        key, equals, value = word.partition("=")
        if not equals or not value:
            raise UsageError(f"--recipe {text}: expected key=value, found '{word}'")
        if key == LABEL:
            label = value
        elif key == MAP:
            map_file = _file(text, value)
        elif key in known:
            settings.append(word)
        elif key in controller:
            found.append(word)
        else:
            raise UsageError(f"--recipe {text}: no setting or parameter '{key}'; see --help")
    values_of(recipe, settings)
    return RecipeLaw(text, label, recipe, tuple(settings), _tracked(recipe, text, found, map_file),
                     map_file)  # fmt: skip


def _file(text: str, value: str) -> Path:
    if not Path(value).is_file():
        raise UsageError(f"--recipe {text}: there is no file {value}")
    return Path(value)


def _tracked(
    recipe: Recipe, text: str, words: Sequence[str], map_file: Path | None
) -> tuple[str, ...]:
    """With the recipe's own tracker where none is named."""
    named = any(word.startswith(f"{TRACKER}=") for word in words)
    if named or not recipe.tracker:
        return tuple(words)
    if recipe.tracker == MAPPED and map_file is None:
        raise UsageError(
            f"--recipe {text}: its tracker {MAPPED} takes a damper's map: {MAP}=FILE (quiesce "
            f"identify inverse), or name another: {TRACKER}=proportional"
        )
    return (*words, f"{TRACKER}={recipe.tracker}")
