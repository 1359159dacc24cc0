"""`quiesce hil`: the published scenarios in closed loop, on the host and on another target."""

import argparse
import dataclasses
import json
import shlex
import sys
import tempfile
from pathlib import Path
from typing import Any

from quiesce.base.atomic import output_files
from quiesce.base.command import real_number, whole_number
from quiesce.base.errors import EXIT_FAILED, UsageError
from quiesce.base.paths import results_folder, results_text, shown, typed
from quiesce.cli.hil_tables import add_options, find_tables, rerun_words
from quiesce.cli.terminal import show
from quiesce.engine import laws, scenarios
from quiesce.engine.bench import Bench, target_options
from quiesce.engine.linux_target import linux_channel
from quiesce.hil.metrics import Result, differing_cases, make_rows, metrics_json, warnings_of
from quiesce.hil.page import make_page
from quiesce.hil.picture import plot_picture
from quiesce.hil.published import load_reference
from quiesce.hil.rig import rig_rows
from quiesce.hil.rig_table import rig_text
from quiesce.hil.rule_surface import rule_surface
from quiesce.hil.runs import (
    OVER_CAN,
    ConstantSearch,
    Plan,
    Run,
    Runner,
    compare_traces,
    measure_speed,
    measure_uart,
)
from quiesce.hil.table import compared_text, comparison_table, summary, target_name

STEADY = ("sine_5Hz", "sine_10Hz", "sine_15Hz", "sine_20Hz")
STEP = "step_10_20Hz"
ON_TARGET = ("sine_5Hz", STEP)
QUICK = ("sine_5Hz", STEP)
SPEED_LAW = "fuzzy"
TARGETS = {"all": ["host", "mps2"], **{target: ["host", target] for target in OVER_CAN}}
TRACE_LAW = "fuzzy"
TRACE_SEEDS = 5
QUICK_TRACE_SEEDS = 2
UART_EXCHANGES = 1600  # eight blocks
TELEMETRY_EVERY = 100

EPILOG = f"""examples:
  quiesce hil                                  everything: table, report, metrics
  quiesce hil --quick                          5 Hz and the step, two seeds, no UART: under a minute
  quiesce hil --scenario step_10_20Hz --law fuzzy --law fuzzy_selftune_printed
  quiesce hil --scenario my_scenario.toml --target host
  quiesce hil --scenario sim_hil/data/rigs/two_storeys.toml    a rig: each body, each damper
  quiesce hil --law fuzzy --rules my_rules.fis --law phase --pulses my_law
  quiesce hil --scenario my_rig.toml --law friction --law-table mine.table --set tracker=inverse \\
      --force-map map.table
  quiesce hil --target host --json | python3 -m json.tool
  quiesce hil --target linux --quick           the Linux controller quiesced, started here
  quiesce hil --target linux --can slcan:tcp:localhost:5556      ... in a virtual machine
  quiesce hil --target linux --can slcan:/dev/ttyACM0,bitrate=500000   ... behind an adapter
  quiesce hil --target linux --can socketcan:can0 --telemetry-every 1

A line on stderr, and "warnings" in metrics.json, say where rules or pulses do not cover what a run
shows.

scenarios: {", ".join((*STEADY, STEP))} (and any .toml file)
laws:      {", ".join(laws.names())}

Without --scenario, 5 Hz and the step run on the image, too. Open loop always runs: reductions are
against it. Written to build/report/hil: index.html, metrics.json, details.json, table.txt and
picture.svg. Exit code 1 where the target does not answer bit for bit like the host.

Of a scenario with a board the table and the page show each body and each damper. A law that needs a
signal which the board lacks is left out, by the signal's name.

Tables go to the laws that take them, on every target: --rules as 'quiesce rules compile
--controller' makes them, --pulses as 'quiesce tune' does (of its folder the parameters, too),
--law-table as 'quiesce law', --force-map as 'quiesce identify inverse'. Command traces are then
compared of a law with a table.

--target linux runs the same scenarios as the image and the host beside it, and drives quiesced
--lockstep, or a board with its lock-step image, tick by tick, over CAN; mps2-uart the image by the
same messages. Command, state and fault of every tick are compared, all words of telemetry every 100
ticks or as --telemetry-every says. Channels: slcan:DEVICE[,baud=N][,bitrate=N] (serial line, pty,
adapter), slcan:unix:PATH, slcan:tcp:HOST:PORT, socketcan:INTERFACE.
"""


def add_parser(commands: argparse._SubParsersAction) -> None:
    parser = commands.add_parser(
        "hil",
        description="Run the controller in closed loop with the simulated structure, on this\n"
        "machine and as the cross-compiled image in QEMU; print published against ours\n"
        "against the best attainable, and write a report.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    repeatable: dict[str, Any] = {"action": "append", "default": []}
    parser.add_argument(
        "--scenario", metavar="NAME", help="name or .toml file, repeatable (all)", **repeatable
    )
    parser.add_argument(
        "--law", metavar="NAME", **repeatable,
        help="law of the tables, or one of the firmware by its own name; repeatable (all of the "
        "tables)",
    )  # fmt: skip
    parser.add_argument(
        "--target", choices=["host", "mps2", "mps2-uart", "linux", "all"], default="all",
        help="this machine, the image in QEMU, that over its UART, the Linux controller over CAN, "
        "or all of the first two (%(default)s)",
    )  # fmt: skip
    parser.add_argument(
        "--can",
        metavar="CHANNEL",
        help="what leads to quiesced --lockstep or to a board's lock-step image (quiesced, started "
        "here)",
    )
    parser.add_argument(
        "--telemetry-every", type=whole_number(1, 65535), metavar="N",
        help=f"ticks between two bursts of all telemetry over CAN ({TELEMETRY_EVERY})",
    )  # fmt: skip
    parser.add_argument(
        "--set", metavar="NAME=VALUE", help="parameter for every law, repeatable", **repeatable
    )
    add_options(parser)
    parser.add_argument(
        "--seed",
        type=whole_number(0, 2**62 - 1),
        metavar="N",
        help="of the sensor noise (scenario's)",
    )
    parser.add_argument(
        "--noise-mg",
        type=real_number(0.0, 1e4),
        metavar="X",
        help="sensor noise, RMS (scenario's: 0.5)",
    )
    parser.add_argument("--quick", action="store_true", help="a shorter run, see below")
    parser.add_argument("--json", action="store_true", help="print metrics.json, not the table")
    parser.add_argument(
        "--out",
        type=Path,
        metavar="DIR",
        help=f"folder of the report ({results_text('report/hil')})",
    )
    parser.set_defaults(run=run)


def make_plan(args: argparse.Namespace, bench: Bench, folder: Path) -> tuple[Plan, Path | None]:
    """The plan, and the table of the rules that it runs; None: those that ship. folder: for tables
    that are made."""
    if any(setting.partition("=")[0] == "law" for setting in args.set):
        raise UsageError("--set law=..: every run has a law of its own; --law NAME chooses them")
    chosen = [laws.find(name) for name in dict.fromkeys(args.law)] or list(laws.LAWS)
    if all(law.name != laws.OPEN_LOOP for law in chosen):
        chosen.insert(0, laws.find(laws.OPEN_LOOP))
    default = QUICK if args.quick else (*STEADY, STEP)
    if args.target in ("mps2", *OVER_CAN):
        default = ON_TARGET
    names = list(dict.fromkeys(args.scenario)) or list(default)
    loaded = [scenarios.load(bench, name) for name in names]
    options = [] if args.seed is None else ["--seed", str(args.seed)]
    options += [] if args.noise_mg is None else ["--noise-mg", str(args.noise_mg)]
    check_noise(args, loaded)
    tables = find_tables(args, bench, chosen, folder)
    plan = Plan(
        scenarios=loaded,
        target_scenarios=[s.name for s in loaded] if args.scenario else ON_TARGET,
        laws=chosen,
        targets=TARGETS.get(args.target, [args.target]),
        is_quick=args.quick,
        settings=args.set,
        options=options,
        telemetry_every=telemetry_every(args),
        tables=tables.options,
        bare=tables.bare,
    )
    return plan, tables.rules


def check_noise(args: argparse.Namespace, loaded: list[scenarios.Scenario]) -> None:
    named = next((scenario for scenario in loaded if scenario.board), None)
    if args.noise_mg is not None and named is not None:
        raise UsageError(
            f"--noise-mg: scenario {named.name} has a board, whose sensors have the noise that "
            "[noise] of the plant file gives each"
        )


def telemetry_every(args: argparse.Namespace) -> int:
    if args.target not in OVER_CAN:
        return 1
    return args.telemetry_every or TELEMETRY_EVERY


def say(text: str) -> None:
    print(text, file=sys.stderr, flush=True)


def judged(
    bench: Bench, plan: Plan, runs: list[Run], name: str, law: str
) -> tuple[scenarios.Scenario, laws.Law]:
    """What is compared and timed: these. Where all that was asked for are rigs, or tables of other
    laws, the run with the most different commands: of a law with a table, or of the first rig."""
    if not plan.has_rigs_only and law in (plan.tables or (law,)):
        return scenarios.load(bench, name), laws.find(law)
    with_table = [run for run in runs if run.case.law.bench_law in plan.tables]
    of_first = [run for run in runs if run.case.scenario is plan.scenarios[0]]
    chosen = max(with_table or of_first, key=lambda run: run.figures["distinct_commands"]).case
    return chosen.scenario, chosen.law


def measure(args: argparse.Namespace, bench: Bench, plan: Plan, runs: list[Run]) -> Result:
    """What must run alone, after the closed-loop runs; then everything put together."""
    reference = load_reference()
    rows, beside = make_rows(runs, reference)
    equal = uart = None
    if plan.checked_target:
        first_seed = 1 if args.seed is None else args.seed
        count = QUICK_TRACE_SEEDS if plan.is_quick else TRACE_SEEDS
        name = target_name(plan.checked_target)
        words = compared_text(plan.telemetry_every)
        say(f"comparing {words}, {name} against host, {count} seeds")
        scenario, law = judged(bench, plan, runs, scenarios.TRACE_EQUALITY, TRACE_LAW)
        equal = compare_traces(
            bench,
            scenario,
            law,
            range(first_seed, first_seed + count),
            plan,
            plan.checked_target,
        )
        equal["telemetry_every"] = plan.telemetry_every
        if scenario.name != scenarios.TRACE_EQUALITY:
            equal["case"] = f"{scenario.name}, {law.label}"
    say("measuring speed, nothing else running")
    speed = measure_speed(bench, *judged(bench, plan, runs, STEP, SPEED_LAW), plan)
    if "mps2" in plan.targets and not plan.is_quick and not plan.has_rigs_only:
        say(f"measuring {UART_EXCHANGES} exchanges over the image's UART and an echo of them")
        uart = measure_uart(bench, UART_EXCHANGES)
    return Result(
        rows, beside, reference.published, equal, differing_cases(runs), speed, uart,
        rig_rows(runs), warnings_of(runs),
    )  # fmt: skip


def details_json(result: Result, searches: list[ConstantSearch], runs: list[Run]) -> dict[str, Any]:
    """What metrics.json has no place for."""
    return {
        "constant_search": [
            {
                "scenario": search.scenario.name,
                "current_mA": search.current_mA,
                "amp_um": [figures["amp_um"] for figures in search.figures],
                "accel_rms_mm_s2": [figures["accel_rms_mm_s2"] for figures in search.figures],
                "rms_disp_um": [figures["rms_disp_um"] for figures in search.figures],
                "best_mA": search.best_mA,
            }
            for search in searches
        ],
        "trace_equal": result.trace_equal,
        "telemetry_differs": result.differing,
        "uart": result.uart,
        "runs": [{**run.figures, "law": run.case.law.name} for run in runs],
    }


def write_json(file: Path, content: dict[str, Any]) -> None:
    file.write_text(json.dumps(content, indent=1) + "\n", encoding="utf-8")


def rerun_command(args: argparse.Namespace) -> str:
    words = typed("quiesce hil").split()
    for option in ("scenario", "law", "set"):
        words += [word for value in getattr(args, option) for word in (f"--{option}", value)]
    words += rerun_words(args)
    if args.target != "all":
        words += ["--target", args.target]
    if args.can is not None:
        words += ["--can", args.can]
    if args.telemetry_every is not None:
        words += ["--telemetry-every", str(args.telemetry_every)]
    if args.seed is not None:
        words += ["--seed", str(args.seed)]
    if args.noise_mg is not None:
        words += ["--noise-mg", f"{args.noise_mg:g}"]
    return shlex.join(words + (["--quick"] if args.quick else []))


def check_target(args: argparse.Namespace) -> None:
    """Refuses what does not go together, and what cannot run here, before anything runs."""
    if args.can is not None and args.target != "linux":
        raise UsageError("--can goes with --target linux only")
    if args.telemetry_every is not None and args.target not in OVER_CAN:
        raise UsageError(f"--telemetry-every goes with --target {' or '.join(OVER_CAN)} only")
    needed = TARGETS.get(args.target, [args.target])
    for target in [*needed, *(["mps2-uart"] if args.target == "mps2" else [])]:
        target_options(target)


def run(args: argparse.Namespace) -> int:
    bench = Bench()
    check_target(args)
    with tempfile.TemporaryDirectory(prefix="quiesce-") as folder:
        plan, rules = make_plan(args, bench, Path(folder))
        for line in plan.left_out():
            say(line)
        if args.target != "linux":
            return run_plan(args, bench, plan, rules)
        with linux_channel(args.can) as channel:
            return run_plan(args, bench, dataclasses.replace(plan, can=channel), rules)


def tables(result: Result) -> list[str]:
    parts = [comparison_table(result)] if result.plain else []
    parts += [rig_text(result.rigs)] if result.rigs else []
    return [*parts, summary(result)]


def run_plan(args: argparse.Namespace, bench: Bench, plan: Plan, rules: Path | None) -> int:
    runner = Runner(bench, plan)
    out = args.out or results_folder() / "report/hil"
    # Opened before the work, so that a folder that cannot be written is known at once.
    with output_files(out) as staging:
        runs, searches = runner.run_all()
        result = measure(args, bench, runner.plan, runs)
        say("drawing the report")
        surface = rule_surface(bench, rules)
        page = make_page(result, runs, searches, surface, rerun_command(args))
        (staging / "index.html").write_text(page, encoding="utf-8")
        write_json(staging / "metrics.json", metrics_json(result))
        write_json(staging / "details.json", details_json(result, searches, runs))
        table = "\n\n".join(tables(result)) + "\n"
        (staging / "table.txt").write_text(table, encoding="utf-8")
        (staging / "picture.svg").write_text(plot_picture(runs), encoding="utf-8")
    if args.json:
        print(json.dumps(metrics_json(result), indent=1))
    else:
        show(f"\n{table}")
        print(f"report: {shown(out / 'index.html')}\nmetrics: {shown(out / 'metrics.json')}")
    for one in result.warnings:
        say(f"quiesce: warning: {one.scenario}, {one.law}: {one.text}")
    return 0 if result.is_equal else EXIT_FAILED
