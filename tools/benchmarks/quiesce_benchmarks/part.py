"""Benchmarks of several parts: what a part is given and gives back, and all of them measured."""

import argparse
import importlib
import pkgutil
import sys
from dataclasses import dataclass, field
from pathlib import Path
from types import ModuleType
from typing import Any

from quiesce.base.errors import BenchFailure, UsageError

from quiesce_benchmarks.report import Figure, Report
from quiesce_benchmarks.seeds import seed_number


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


def all_parts(package: ModuleType) -> dict[str, ModuleType]:
    """By name, sorted. Each has TITLE, FIGURES ((name, unit, goal or None, better), ...) and
    measure(effort) -> Measured."""
    names = sorted(one.name for one in pkgutil.iter_modules(package.__path__))
    return {name: importlib.import_module(f"{package.__name__}.{name}") for name in names}


def add_options(parser: argparse.ArgumentParser, package: ModuleType) -> None:
    parser.add_argument(
        "--part", choices=list(all_parts(package)), action="append", help="only this"
    )
    parser.add_argument("--seed", type=seed_number, default=1, help="(%(default)s)")


def measure(name: str, package: ModuleType, args: argparse.Namespace, folder: Path) -> Report:
    """Those parts that --part names, or all; one that fails is absent with its reason."""
    figures: list[Figure] = []
    absent: list[str] = []
    tables: list[str] = []
    context: dict[str, Any] = {"seed": args.seed, "quick": args.quick, "reported": {}}
    effort = Effort(args.seed, args.quick, folder)
    for key, part in all_parts(package).items():
        found = Measured({})
        if args.part is not None and key not in args.part:
            absent.append(f"{key}: left out")
        else:
            print(f"{name}: {part.TITLE}", file=sys.stderr, flush=True)
            try:
                found = part.measure(effort)
            except (BenchFailure, UsageError) as error:
                absent.append(f"{key}: {error}")
        figures += [Figure(one, found.values.get(one), *rest) for one, *rest in part.FIGURES]
        context["reported"][key] = found.reported
        tables += found.tables
    return Report(name, figures, context, tables, absent)
