"""The campaign's file: what is varied, how, and what is measured."""

import hashlib
import math
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from quiesce.base.errors import UsageError, one_line
from quiesce.base.named_files import files_in
from quiesce.base.nearest import listed, meant
from quiesce.base.paths import shown
from quiesce.campaign.design import GRID, METHODS, MORRIS, POWER_OF_2, SALTELLI, Design, has_ends
from quiesce.campaign.documents import Documents
from quiesce.campaign.factors import (
    PLUS,
    SET,
    TIMES,
    Assignment,
    Choices,
    Factor,
    Level,
    Spread,
    evenly,
    level_of,
)
from quiesce.campaign.recipe import (
    BOARD,
    FILES,
    LAW,
    PARAMETER,
    PLANT,
    SCENARIO,
    TABLES,
    Recipe,
    require_file,
    require_key,
)
from quiesce.campaign.store import OWN

SCHEMA, VERSION = "quiesce-campaign", 1
FIGURES = (
    "amp_um",
    "disp_rms_um",
    "peak_disp_um",
    "accel_rms_mm_s2",
    "mean_current_A",
    "damper_work_J",
    "faults",
)
MOST_CASES = 10_000_000
MOST_SEED = 2**63 - 1
BASE_KEYS = (LAW, PLANT, BOARD, *TABLES)
KEYS = ("schema", "version", "name", "seed", SCENARIO, *BASE_KEYS, PARAMETER, "figures", "worst",
        "sampling", "factor")  # fmt: skip
FACTOR_KEYS = ("name", "key", "values", "choice", "low", "high", "mean", "std", "log", "integer",
               "times", "plus", "count", "crossed")  # fmt: skip


@dataclass(frozen=True)
class Campaign:
    """text: of the file. worst: figures whose largest values are told."""

    file: Path
    text: str
    name: str
    design: Design
    recipe: Recipe
    worst: tuple[str, ...]

    @property
    def sha256(self) -> str:
        return hashlib.sha256(self.text.encode()).hexdigest()

    def inputs(self) -> list[Path]:
        """Every file that a case may read, sorted."""
        named = {Path(name) for name in self.recipe.documents}
        named |= set(files_in(list(self.recipe.base.values())))
        for factor in self.design.factors:
            if isinstance(factor, Choices):
                sets = [one.value for level in factor.levels for one in level.sets]
                named |= set(files_in(sets))
        for data in self.recipe.documents.values():
            named |= set(files_in(data))
        return sorted(named)


class Reader:
    """Of one table of the file. All functions throw UsageError, which names it and the key."""

    def __init__(self, table: Mapping[str, Any], place: str, keys: Sequence[str]) -> None:
        self.table, self.place = table, place
        for key in table:
            if key not in keys:
                raise UsageError(f"{place}: unknown key '{key}'{meant(key, keys)}")

    def has(self, key: str) -> bool:
        return key in self.table

    def text(self, key: str) -> str:
        value = self.table.get(key)
        if not isinstance(value, str) or not value:
            raise UsageError(f"{self.place}: {key}: expected a text, found {_told(value)}")
        return value

    def number(self, key: str) -> float:
        value = self.table.get(key)
        is_number = isinstance(value, int | float) and not isinstance(value, bool)
        if not is_number or not math.isfinite(value):  # type: ignore[arg-type]
            raise UsageError(f"{self.place}: {key}: expected a number, found {_told(value)}")
        return value  # type: ignore[return-value]

    def integer(self, key: str, low: int, high: int, usual: int | None = None) -> int:
        value = self.table.get(key, usual)
        if isinstance(value, bool) or not isinstance(value, int) or not low <= value <= high:
            raise UsageError(
                f"{self.place}: {key}: expected an integer in {low} .. {high}, found {_told(value)}"
            )
        return value

    def flag(self, key: str) -> bool:
        value = self.table.get(key, False)
        if not isinstance(value, bool):
            raise UsageError(f"{self.place}: {key}: expected true or false, found {_told(value)}")
        return value

    def items(self, key: str) -> list[Any]:
        value = self.table.get(key, [])
        if not isinstance(value, list) or not value:
            raise UsageError(f"{self.place}: {key}: expected an array, found {_told(value)}")
        return value

    def tables(self, key: str) -> list[dict[str, Any]]:
        found = self.items(key)
        if not all(isinstance(one, dict) for one in found):
            raise UsageError(f"{self.place}: {key}: expected tables, [[{key}]]")
        return found

    def inner(self, key: str, keys: Sequence[str]) -> "Reader":
        value = self.table.get(key)
        if not isinstance(value, dict):
            raise UsageError(f"{self.place}: {key}: expected a table, found {_told(value)}")
        return Reader(value, f"{self.place}: {key}", keys)


def _told(value: Any) -> str:
    return "nothing" if value is None else one_line(repr(value))[:60]


def read_campaign(file: Path) -> Campaign:
    """UsageError where it is not a campaign, with the table and the key that are wrong."""
    place = shown(file)
    try:
        text = file.read_bytes().decode("utf-8")
        data = tomllib.loads(text)
    except OSError as error:
        raise UsageError(f"{place}: {error.strerror}; name a campaign file")
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise UsageError(f"{place}: not a TOML file: {one_line(error)}")
    root = Reader(data, place, KEYS)
    if data.get("schema") != SCHEMA or data.get("version") != VERSION:
        raise UsageError(f'{place}: expected schema = "{SCHEMA}" and version = {VERSION}')
    folder = file.resolve().parent
    base = _base(root, folder)
    factors = tuple(
        _factor(one, f"{place}: factor {i}", folder)
        for i, one in enumerate(root.tables("factor"), 1)
    )
    figures = _figures(root)
    _require_names([one.name for one in factors], figures, place)
    documents = Documents()
    _load(documents, base, factors)
    recipe = Recipe(base, documents, figures)
    design = _design(root, factors)
    recipe.parts(design.case(0))  # what no case can have is told before any runs
    return Campaign(file.resolve(), text, root.text("name"), design, recipe, _worst(root, figures))


def _base(root: Reader, folder: Path) -> dict[str, Any]:
    base = {
        SCENARIO: require_file(SCENARIO, root.text(SCENARIO), folder, f"{root.place}: scenario")
    }
    for key in BASE_KEYS:
        if root.has(key):
            base[key] = require_file(key, root.text(key), folder, f"{root.place}: {key}")
    if root.has(PARAMETER):
        settings = root.table[PARAMETER]
        if not isinstance(settings, dict):
            raise UsageError(f"{root.place}: {PARAMETER}: expected a table of NAME = VALUE")
        base |= {f"{PARAMETER}.{name}": value for name, value in settings.items()}
    return base


def _figures(root: Reader) -> tuple[str, ...]:
    if not root.has("figures"):
        return FIGURES
    found = root.items("figures")
    if not all(isinstance(one, str) and all(one.split(".")) for one in found):
        raise UsageError(
            f"{root.place}: figures: expected names such as amp_um or windows.1.amp_um"
        )
    return tuple(found)


def _worst(root: Reader, figures: Sequence[str]) -> tuple[str, ...]:
    if not root.has("worst"):
        return figures[:1]
    found = root.items("worst")
    for one in found:
        if one not in figures:
            raise UsageError(f"{root.place}: worst: {listed(str(one), figures)}")
    return tuple(found)


def _require_names(factors: Sequence[str], figures: Sequence[str], place: str) -> None:
    """Columns of the store, whose names do not differ by case alone."""
    seen = set(OWN)
    for name in [*factors, *figures]:
        if name.lower() in seen:
            raise UsageError(f"{place}: two columns would be called '{name}'; give a factor a name")
        seen.add(name.lower())


def _factor(table: dict[str, Any], place: str, folder: Path) -> Factor:
    reader = Reader(table, place, FACTOR_KEYS)
    if reader.has("choice"):
        return _choices(reader, folder)
    key = reader.text("key")
    how = TIMES if reader.flag("times") else PLUS if reader.flag("plus") else SET
    require_key(key, how, place)
    name = reader.text("name") if reader.has("name") else key
    if reader.has("values"):
        levels = [
            level_of(key, require_file(key, value, folder, place), how)
            for value in reader.items("values")
        ]
        return _distinct(Choices(name, tuple(levels), reader.flag("crossed")), place)
    return _spread(reader, name, key, how)


def _choices(reader: Reader, folder: Path) -> Choices:
    name, levels = reader.text("name"), []
    for i, one in enumerate(reader.tables("choice"), 1):
        place = f"{reader.place}, choice {i}"
        choice = Reader(one, place, ("label", "set"))
        sets = choice.table.get("set")
        if not isinstance(sets, dict) or not sets:
            raise UsageError(f'{place}: set: expected a table such as {{ law = "off" }}')
        for key in sets:
            require_key(key, SET, place)
        found = [Assignment(k, require_file(k, v, folder, place)) for k, v in sets.items()]
        levels.append(Level(choice.text("label"), tuple(found)))
    return _distinct(Choices(name, tuple(levels), reader.flag("crossed")), reader.place)


def _distinct(choices: Choices, place: str) -> Choices:
    labels = [level.label for level in choices.levels]
    if len(set(map(str, labels))) < len(labels):
        raise UsageError(f"{place}: two of its values are the same")
    return choices


def _spread(reader: Reader, name: str, key: str, how: str) -> Factor:
    is_normal = reader.has("mean") or reader.has("std")
    low = reader.number("mean" if is_normal else "low")
    high = reader.number("std" if is_normal else "high")
    is_log, is_whole = reader.flag("log"), reader.flag("integer")
    if is_normal and (high <= 0.0 or is_log or is_whole):
        raise UsageError(f"{reader.place}: expected std > 0, without log and integer")
    if not is_normal and low >= high:
        raise UsageError(f"{reader.place}: expected low below high")
    if is_log and low <= 0.0:
        raise UsageError(f"{reader.place}: log: expected low above 0")
    if is_whole and (is_log or low != int(low) or high != int(high)):
        raise UsageError(f"{reader.place}: integer: expected low and high as integers, without log")
    found = Spread(name, key, low, high, how, is_log, is_normal, is_whole)
    if reader.has("count"):
        return evenly(found, reader.integer("count", 1, MOST_CASES))
    if reader.flag("crossed"):
        raise UsageError(f"{reader.place}: crossed: of a range it needs count, how many of it")
    return found


def _load(documents: Documents, base: Mapping[str, Any], factors: Sequence[Factor]) -> None:
    """Every TOML file that a case may be made of."""
    sets = [Assignment(key, value) for key, value in base.items()]
    for factor in factors:
        if isinstance(factor, Choices):
            sets += [one for level in factor.levels for one in level.sets]
    for one in sets:
        if one.key in FILES:
            documents.add(Path(one.value))
        else:
            for file in files_in(one.value):
                if file.suffix == ".toml":
                    documents.add(file)


def _design(root: Reader, factors: tuple[Factor, ...]) -> Design:
    sampling = root.inner("sampling", ("method", "cases"))
    method = sampling.text("method")
    if method not in METHODS:
        raise UsageError(f"{sampling.place}: method: no '{method}'; {listed(method, METHODS)}")
    if method == GRID:
        factors = tuple(_for_grid(one, root.place) for one in factors)
    count = sampling.integer("cases", 1, MOST_CASES, 1 if method == GRID else None)
    if method in POWER_OF_2 and count & (count - 1):
        raise UsageError(f"{sampling.place}: cases: {method} needs a power of 2, such as 1024")
    for one in factors:
        if method == MORRIS and not has_ends(one):
            raise UsageError(f"{root.place}: {one.name}: morris needs low and high, no mean")
    seed = root.integer("seed", 0, MOST_SEED, 1)
    _require_size(factors, method, count, sampling.place)
    return Design(factors, method, count, seed)


def _for_grid(factor: Factor, place: str) -> Factor:
    if isinstance(factor, Spread):
        raise UsageError(f"{place}: {factor.name}: a grid needs values, or count, how many of it")
    return Choices(factor.name, factor.levels, True)


def _require_size(factors: Sequence[Factor], method: str, count: int, place: str) -> None:
    """Before anything of that size is made."""
    total, sampled = count, 0
    for one in factors:
        if isinstance(one, Choices) and one.is_crossed:
            total *= len(one.levels)
        else:
            sampled += 1
    if sampled and method in (MORRIS, SALTELLI):
        total *= sampled + (1 if method == MORRIS else 2)
    if total > MOST_CASES:
        raise UsageError(f"{place}: {total} cases; at most {MOST_CASES} can be asked for")
