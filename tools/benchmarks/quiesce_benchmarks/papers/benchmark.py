"""`./tools/benchmark papers`: what the five papers published, beside what comes out here."""

import argparse
import sys
from pathlib import Path
from typing import Any

from quiesce.base.errors import BenchFailure, UsageError

from quiesce_benchmarks.papers.part import Effort, Measured, all_parts
from quiesce_benchmarks.report import Figure, Report
from quiesce_benchmarks.seeds import seed_number

NAME = "papers"
HELP = "equations, tables and figures of five papers: published beside ours"
DESCRIPTION = """Makes again what the five papers published, on their protocols, and prints it
beside what they printed. Each part can be had by itself."""


def add_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--part", choices=list(all_parts()), action="append", help="only this")
    parser.add_argument("--seed", type=seed_number, default=1, help="(%(default)s)")


def measure(args: argparse.Namespace, folder: Path) -> Report:
    figures: list[Figure] = []
    absent: list[str] = []
    tables: list[str] = []
    context: dict[str, Any] = {"seed": args.seed, "quick": args.quick, "reported": {}}
    effort = Effort(args.seed, args.quick, folder)
    for name, part in all_parts().items():
        found = Measured({})
        if args.part is not None and name not in args.part:
            absent.append(f"{name}: left out")
        else:
            print(f"papers: {part.TITLE}", file=sys.stderr, flush=True)
            try:
                found = part.measure(effort)
            except (BenchFailure, UsageError) as error:
                absent.append(f"{name}: {error}")
        figures += [Figure(key, found.values.get(key), *rest) for key, *rest in part.FIGURES]
        context["reported"][name] = found.reported
        tables += found.tables
    return Report(NAME, figures, context, tables, absent)
