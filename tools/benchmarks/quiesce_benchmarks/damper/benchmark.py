"""`./tools/benchmark identify`: damper models on measured dampers, synthetic truth, speed."""

import argparse
import json
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

from quiesce.base.errors import UsageError
from quiesce.base.paths import measurements, shown
from quiesce.base.progress import Progress

from quiesce_benchmarks.report import Figure, Report

NAME = "identify"
HELP = "damper models: measured dampers held out, synthetic truth, speed"
DESCRIPTION = """Measured dampers by the rules of tools/benchmarks/dampers/scoring.toml: the better
of two static baselines, and our models, chosen by validation inside the training part and scored on
held-out rows. One parameter set over five currents. Synthetic truth: are parameters and intervals
right? Speed of the batched evaluator against scipy's integrator and against ourselves, one by one,
and of a whole fit against scipy's differential evolution. --quick: fewer trials, and of the
measured sets the three that take minutes."""

PARTS = ("real", "one-set", "truth", "bw7", "speed")


def add_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--part", action="append", choices=PARTS, help="only this; repeatable")
    parser.add_argument(
        "--set", action="append", metavar="NAME", help="only this measured set; repeatable"
    )
    parser.add_argument(
        "--models", metavar="NAMES", help="models for the measured sets, with commas, or all"
    )
    parser.add_argument("--seed", type=int, default=1, help="(%(default)d)")
    parser.add_argument(
        "--jobs", type=int, default=os.cpu_count() or 1, metavar="N", help="threads (%(default)s)"
    )


def measure(args: argparse.Namespace, folder: Path) -> Report:
    parts = args.part or list(PARTS)
    figures: list[Figure] = []
    tables: list[str] = []
    absent: list[str] = []
    if "real" in parts:
        collect(real_part(args, folder), figures, tables, absent)
    if "one-set" in parts:
        collect(one_set_part(args), figures, tables, absent)
    for name in ("truth", "bw7", "speed"):
        if name in parts:
            collect(module_part(name, args, folder), figures, tables, absent)
    context: dict[str, Any] = {"seed": args.seed, "quick": args.quick, "parts": list(parts)}
    return Report(NAME, figures, context, tables, absent)


def collect(
    found: tuple[list[Figure], list[str], list[str]],
    figures: list[Figure],
    tables: list[str],
    absent: list[str],
) -> None:
    for out, new in zip((figures, tables, absent), found, strict=True):
        out.extend(new)


def real_part(args: argparse.Namespace, folder: Path) -> tuple[list[Figure], list[str], list[str]]:
    from quiesce.damper.candidates import names_of

    from quiesce_benchmarks.damper import real

    entries = real.rules()["set"]
    known = [entry["name"] for entry in entries]
    for name in args.set or []:
        if name not in known:
            raise UsageError(f"--set {name}: there are {', '.join(known)}")
    wanted = args.set or (real.QUICK_SETS if args.quick else known)
    chosen = [one for one in entries if one["name"] in wanted]
    models = names_of(args.models) if args.models else list(real.MODELS)
    data = real.data_folder()
    if data is None:
        return (
            absent_figures(chosen),
            [],
            [no_data()],
        )
    figures, tables = [], []
    progress = Progress(len(chosen) * (len(models) + 1))
    for entry in chosen:
        result = real.run_set(entry, data, models, args.seed, args.quick, args.jobs, progress.done)
        figures += result.figures()
        tables.append(result.table())
        write_models(folder, result)
    return figures, tables, []


def no_data() -> str:
    return f"no measurements at {shown(measurements('mr_damper'))}: measured dampers not judged"


def write_models(folder: Path, result: Any) -> None:
    """The models of a set's winners, and all errors, for reports."""
    from quiesce.damper.report.tables import json_model

    rows = [json_model(one) for one in result.fitted]
    text = json.dumps(rows, indent=1, default=str)
    (folder / f"{result.name}.json").write_text(text + "\n", encoding="utf-8")
    winner = result.winner.damper.to_toml()
    (folder / f"{result.name}.toml").write_text(winner, encoding="utf-8")


def absent_figures(entries: list[dict[str, Any]]) -> list[Figure]:
    from quiesce_benchmarks.damper.real import GOALS, LAGGED_GOAL

    out = []
    for one in entries:
        ratio, error = GOALS.get(one["name"], (None, None))
        out.append(Figure(f"error_{one['name']}_best", None, "1", error, "lower"))
        out.append(Figure(f"unexplained_ratio_{one['name']}", None, "1", ratio, "lower"))
        if one.get("lagged_baseline"):
            out.append(Figure("unexplained_ratio_dyke_lagged", None, "1", LAGGED_GOAL, "lower"))
    return out


def one_set_part(args: argparse.Namespace) -> tuple[list[Figure], list[str], list[str]]:
    from quiesce_benchmarks.damper import one_set as one
    from quiesce_benchmarks.damper.real import data_folder

    data = data_folder()
    if data is None:
        missing = [
            Figure("one_set_in_sample_pct", None, "%", one.IN_SAMPLE_GOAL_pct, "lower"),
            Figure("one_set_held_out_pct", None, "%", one.HELD_OUT_GOAL_pct, "lower"),
        ]
        return (
            missing,
            [],
            [no_data()],
        )
    records = one.records_of_test(data)
    say: Callable[[str], None] = Progress(4 if args.quick else 8).done
    figures, table = one.one_set(records, args.seed, say)
    tables = [table]
    if not args.quick:
        tables.append(one.scenarios(records, args.seed, say))
    return figures, tables, []


def module_part(
    name: str, args: argparse.Namespace, folder: Path
) -> tuple[list[Figure], list[str], list[str]]:
    """Parts that need no data: modules with figures(quick, folder) -> figures and tables."""
    from importlib import import_module

    figures, tables = import_module(f"quiesce_benchmarks.damper.{name}").figures(args.quick, folder)
    return figures, tables, []
