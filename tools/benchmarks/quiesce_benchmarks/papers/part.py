"""What a part of `./tools/benchmark papers` is given and gives back."""

import importlib
import pkgutil
from dataclasses import dataclass, field
from pathlib import Path
from types import ModuleType
from typing import Any

from quiesce_benchmarks.papers import parts


@dataclass(frozen=True)
class Effort:
    seed: int
    is_quick: bool  # fewer trials, the same figures
    folder: Path  # for plots


@dataclass(frozen=True)
class Measured:
    """What came out of a part. `values` of its FIGURES by name; `reported` is for pages: values of
    JSON under a key a row can name; `tables` are for people."""

    values: dict[str, float | None]
    reported: dict[str, Any] = field(default_factory=dict)
    tables: tuple[str, ...] = ()


def all_parts() -> dict[str, ModuleType]:
    """By name, sorted. Each has TITLE, FIGURES ((name, unit, goal or None, better), ...) and
    measure(effort) -> Measured."""
    names = sorted(one.name for one in pkgutil.iter_modules(parts.__path__))
    return {name: importlib.import_module(f"{parts.__name__}.{name}") for name in names}
