"""`./tools/benchmark trust`: mistakes in the guarding code, abuse, flipped bits, cost."""

import argparse
import json
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

from quiesce.base.command import whole_number
from quiesce.base.errors import BenchFailure, UsageError
from quiesce.base.paths import build_folder, root
from quiesce.engine.bench import Bench

from quiesce_benchmarks.controller import instructions
from quiesce_benchmarks.report import Figure, Report
from quiesce_benchmarks.seeds import seed_number
from quiesce_benchmarks.trust import (
    abuse,
    congestion,
    defects,
    flips,
    frames,
    heat,
    latch,
    mutants,
    sweeps,
)
from quiesce_benchmarks.trust.trial import default_jobs

NAME = "trust"
HELP = "mistakes in the guarding code that tests notice, abuse, flipped bits, what guarding costs"
DESCRIPTION = """Makes small mistakes in the code that guards the output and counts how many of them
the C tests and the golden streams notice; drives controllers with everything that can come in and
counts ticks in which a rule is broken (range, slew, safe current, driver, stop, latch, arming);
sends it single frames that are repeated, delayed, inserted or reordered; kills the Linux
controller at its system calls and takes its disk away; flips bits of its memory, and of the
parameters, tables and program that it reads, and looks at what it then commands; heats coils for a
day; halves the rate of its line; counts the instructions that guarding costs."""

# Name, unit, goal, better.
FIGURES = (
    ("defects_open", "1", 0, "lower"),
    ("mutants", "1", 300, "higher"),
    ("mutants_killed_pct", "%", 97, "higher"),
    ("mutants_equivalent_pct", "%", 2, "lower"),
    ("table_killed_pct", "%", 100, "higher"),
    ("abuse_ticks", "ticks", 10**8, "higher"),
    ("abuse_violations", "ticks", 0, "lower"),
    ("reaction_ticks_worst_estop", "ticks", 1, "lower"),
    ("reaction_ticks_worst_record", "ticks", 2, "lower"),
    ("frames_abused", "1", 10**6, "higher"),
    ("frames_with_effect", "1", 0, "lower"),
    ("latch_kills", "1", 100, "higher"),
    ("latch_lost", "1", 0, "lower"),
    ("latch_starts_not_refused", "1", 0, "lower"),
    ("flips_tried", "1", 10**6, "higher"),
    ("flips_unsafe", "1", 0, "lower"),
    ("flip_noticed_s", "s", 1, "lower"),
    ("flip_reaction_ticks", "ticks", 2, "lower"),
    ("flips_swept_unsafe", "1", 0, "lower"),
    ("heat_above_s", "s", 0, "lower"),
    ("heat_hours", "h", 24, "higher"),
    ("congested_replies_pct", "%", 99, "higher"),
    ("congested_demand_lost", "1", 0, "lower"),
    ("instr_added", "instructions", 400, "lower"),
    ("damper_extra_instr", "instructions", 250, "lower"),
)
PARTS = (
    "defects",
    "mutants",
    "abuse",
    "frames",
    "latch",
    "flips",
    "sweeps",
    "heat",
    "congestion",
    "cost",
)
QUICK_MUTANTS = 30
# Worst ticks of the laws before there were guards for all of this.
BASELINE = Path(__file__).with_name("baseline.json")


def add_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--full", action="store_true", help="every mutant, ten times the ticks")
    parser.add_argument("--part", choices=PARTS, action="append", help="only this; may be repeated")
    parser.add_argument("--seed", type=seed_number, default=mutants.SEED, help="(%(default)s)")
    parser.add_argument("--ticks", type=whole_number(1, 10**12), help="of abuse (100,000,000)")
    parser.add_argument(
        "--jobs", type=whole_number(1, 256), default=default_jobs(), help="(%(default)s)"
    )


def measure(args: argparse.Namespace, folder: Path) -> Report:
    values: dict[str, float] = {}
    absent: list[str] = []
    tables: list[str] = []
    context: dict[str, Any] = {"seed": args.seed}

    def take(part: str, work: Callable[[], dict[str, float]]) -> None:
        if args.part is not None and part not in args.part:
            absent.append(f"{part}: left out")
            return
        print(f"trust: {part}, seed {args.seed}", file=sys.stderr, flush=True)
        try:
            values.update(work())
        except (BenchFailure, UsageError) as error:
            absent.append(f"{part}: {error}")

    def mistakes() -> dict[str, float]:
        found, table = mutants.measure(
            root(), build_folder() / "host", count_of(args), args.seed, args.jobs
        )
        survivors = [mutants.line_of(one) for one in found.survivors + table.survivors]
        context["mutants_survived"] = survivors
        tables.append("\n".join(["mutants that survive:", *survivors]) if survivors else "")
        return {
            "mutants": found.tried,
            "mutants_killed_pct": found.killed_pct,
            "mutants_equivalent_pct": found.equivalent_pct,
            "table_entries": table.tried,
            "table_killed_pct": table.killed_pct,
        }

    def found() -> dict[str, float]:
        values, left = defects.measure(root(), build_folder())
        tables.append("\n".join(["defects that are open:", *left]) if left else "")
        return {**values, "defects_open": len(left)}

    take("defects", found)
    take("mutants", mistakes)
    take("abuse", lambda: abuse.measure(ticks_of(args), args.seed, args.jobs))
    take("frames", lambda: frames.measure(args.seed, args.quick, args.jobs))
    take("latch", lambda: latch.measure(args.quick))
    take("flips", lambda: flips.measure(args.seed, args.quick, args.jobs))
    take("sweeps", lambda: sweeps.measure(args.seed, args.quick, args.jobs))
    take("heat", lambda: heat.measure(args.seed, args.quick, args.jobs))
    take("congestion", congestion.measure)
    take("cost", lambda: cost(Bench(), args.quick))
    figures = [Figure(name, values.get(name), *rest) for name, *rest in FIGURES]
    context |= {name: value for name, value in values.items() if name not in names()}
    return Report(NAME, figures, context, [table for table in tables if table], absent)


def names() -> set[str]:
    return {name for name, *_ in FIGURES}


def count_of(args: argparse.Namespace) -> int | None:
    if args.full:
        return None
    return QUICK_MUTANTS if args.quick else mutants.COUNT


def ticks_of(args: argparse.Namespace) -> int:
    if args.ticks is not None:
        return int(args.ticks)
    if args.full:
        return abuse.FULL_TICKS
    return abuse.QUICK_TICKS if args.quick else abuse.TICKS


def cost(bench: Bench, quick: bool) -> dict[str, float]:
    before = json.loads(BASELINE.read_text())["worst_instr"]
    worst = {law: found[1] for law, found in instructions.of_laws(bench, quick).items()}
    added = {law: worst[law] - before[law] for law in before}
    extra = instructions.extra(bench)["damper"]
    return {
        "instr_added": max(added.values()),
        "damper_extra_instr": extra,
        **{f"{law}_instr_added": value for law, value in added.items()},
    }
