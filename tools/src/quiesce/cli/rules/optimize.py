"""`quiesce rules optimize`: searches rule tables and set positions on the plant, in closed loop."""

import argparse
import json
import os
import shlex
import tempfile
from concurrent.futures import Executor, ThreadPoolExecutor
from contextlib import contextmanager
from pathlib import Path

from quiesce.base.atomic import output_files
from quiesce.base.command import whole_number
from quiesce.base.errors import EXIT_INTERRUPTED, UsageError
from quiesce.base.paths import default_plant, results_folder, results_text, shown, typed
from quiesce.base.progress import say
from quiesce.cli.rules.arguments import add_settle, drives_V, freqs_Hz
from quiesce.cli.terminal import show
from quiesce.engine import scenarios
from quiesce.engine.bench import Bench
from quiesce.engine.params import effective_params
from quiesce.engine.scenarios import Scenario
from quiesce.rules.formats.files import read_rules
from quiesce.rules.optimize import state as optimize_state
from quiesce.rules.optimize.evaluate import driver_max_A, require_bench_option
from quiesce.rules.optimize.genes import RULES, SETS, TUNABLE
from quiesce.rules.optimize.methods import GA, METHODS, SELECTIONS, method_settings
from quiesce.rules.optimize.objective import OBJECTIVES, Objective, parse_weights
from quiesce.rules.optimize.report import headline, write_report
from quiesce.rules.optimize.result import Found, result_json, text_sections
from quiesce.rules.optimize.run import Limits
from quiesce.rules.optimize.scenarios import SETTLE_s, Steadies, plant_file, steady_scenarios
from quiesce.rules.optimize.session import Session, Task, start_from_recipe
from quiesce.rules.optimize.start import start_freqs_Hz
from quiesce.rules.optimize.state import FILE_NAME, unfinished

STEADY = ("sine_5Hz", "sine_10Hz", "sine_15Hz", "sine_20Hz")
BOTH = "both"

EPILOG = f"""examples:
  quiesce rules optimize                                  rule table, 5, 10, 15 and 20 Hz, GA
  quiesce rules optimize --freq 4,5,6,7,8,9,10,12 --tune both --method de --generations 60
  quiesce rules optimize --scenario my_scenario.toml --start my_rules.fcl --objective thrifty
  quiesce rules optimize --plant mine/plant.toml --freq 2,2.9,4 --settle 17 --out mine/rules
  quiesce rules optimize --method nsga2 --objective thrifty
  quiesce rules optimize --resume                         goes on where it was interrupted

The cost is the weighted mean of what is left, in %: displacement amplitude and RMS acceleration of
those at 0 A, mean current of the largest. Objectives set the weights of displacement, acceleration
and current: {"; ".join(f"{k} {' '.join(f'{w:g}' for w in v)}" for k, v in OBJECTIVES.items())}.

Without --start the search begins at the published recipe: sets at the frequencies of the scenarios
(of the published plant 5, 10, 15 and 20 Hz), the constant current of least RMS acceleration at each
('quiesce rules lookup').

Written to build/report/rules_optimize: best.fcl, report.html, report.md, result.json (nsga2: one
rule file for every point of the front), and during the search state.json. The same seed and options
give the same result, interrupted or not, whatever --jobs is.
"""


def add_parser(commands: argparse._SubParsersAction) -> None:
    parser = commands.add_parser(
        "optimize",
        help="search rule tables and set positions on the plant, in closed loop",
        description="Search rule tables and set positions on the plant, in closed loop with the\n"
        "controller: genetic algorithm, differential evolution, several objectives at once,\n"
        "or a search that papers name (pso, cmaes, es, cuckoo, bees).",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    add_what(parser)
    add_how(parser)
    parser.set_defaults(run=run)


def add_what(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--scenario", metavar="NAME", action="append", default=[],
        help="name or .toml file, repeatable (steady 5, 10, 15 and 20 Hz)",
    )  # fmt: skip
    parser.add_argument("--freq", metavar="HZ,...", help="steady vibration at these, too")
    parser.add_argument("--drive", metavar="V,...", help="of each --freq (the plant's)")
    parser.add_argument("--plant", metavar="FILE", help="of --freq (squeeze_2012.toml)")
    add_settle(parser)
    parser.add_argument("--start", metavar="FILE", help="rule file to begin at (the recipe)")
    parser.add_argument(
        "--tune", metavar="WHAT", default=RULES,
        help="rules, sets (their positions), outputs (singletons), both (rules,sets), or several "
        "with commas (%(default)s)",
    )  # fmt: skip
    parser.add_argument(
        "--objective", choices=list(OBJECTIVES), default="balanced", help="weights (%(default)s)"
    )
    parser.add_argument(
        "--weight", metavar="PART=X", action="append", default=[],
        help="displacement, acceleration or current, repeatable; in place of the objective's",
    )  # fmt: skip
    parser.add_argument(
        "--set", metavar="NAME=VALUE", action="append", default=[],
        help="parameter for every run, repeatable",
    )  # fmt: skip


def add_how(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--method", choices=METHODS, default=GA, help="(%(default)s)")
    parser.add_argument(
        "--selection", choices=SELECTIONS, default=SELECTIONS[0], help="of the GA (%(default)s)"
    )
    parser.add_argument(
        "--population", type=whole_number(4, 1000), metavar="N", help="(24; nsga2: 40)"
    )
    parser.add_argument(
        "--generations", type=whole_number(1, 100000), default=30, metavar="N", help="(%(default)s)"
    )
    parser.add_argument(
        "--evaluations", type=whole_number(1, 10**7), metavar="N",
        help="end after the generation in which so many rule bases have been tried",
    )  # fmt: skip
    parser.add_argument(
        "--seed",
        type=whole_number(0, 2**62),
        default=1,
        metavar="N",
        help="of the search (%(default)s)",
    )
    parser.add_argument(
        "--jobs", type=whole_number(1, 256), default=os.cpu_count() or 1, metavar="N",
        help="closed-loop runs at once (%(default)s)",
    )  # fmt: skip
    parser.add_argument("--resume", action="store_true", help="go on with the search in --out")
    parser.add_argument("--anew", action="store_true", help="drop an unfinished search in --out")
    parser.add_argument("--json", action="store_true", help="print result.json, not the tables")
    parser.add_argument(
        "--out", type=Path, metavar="DIR", help=f"folder ({results_text('report/rules_optimize')})"
    )


def parse_tune(text: str) -> list[str]:
    parts = text.split(",")
    words = [word for part in parts for word in ([RULES, SETS] if part == BOTH else [part])]
    if not all(word in TUNABLE for word in words):
        raise UsageError(f"--tune {text}: expected {', '.join(TUNABLE)}, or {BOTH}")
    return [word for word in TUNABLE if word in words]


def chosen_scenarios(args: argparse.Namespace, bench: Bench, folder: Path) -> list[Scenario]:
    if not args.freq and (args.drive or args.plant):
        raise UsageError("--drive and --plant belong to --freq, which is not given")
    names = list(dict.fromkeys(args.scenario)) or ([] if args.freq else list(STEADY))
    chosen = [scenarios.load(bench, name) for name in names]
    if args.freq:
        drives = drives_V(args.drive) if args.drive else [None]
        freqs, plant = freqs_Hz(args.freq), plant_file(args.plant)
        chosen += steady_scenarios(bench, folder, plant, freqs, drives, args.settle)
    return chosen


def start_steadies(args: argparse.Namespace, chosen: list[Scenario]) -> Steadies:
    """What the recipe is made from."""
    plant = chosen[0].plant_file
    is_published = plant == default_plant().resolve()
    drives = drives_V(args.drive) if args.drive and not is_published else [None]
    freqs_Hz = start_freqs_Hz([scenario.file for scenario in chosen], is_published)
    return Steadies(plant, freqs_Hz, drives, SETTLE_s if is_published else args.settle)


def make_task(args: argparse.Namespace, bench: Bench, folder: Path, pool: Executor) -> Task:
    tune = parse_tune(args.tune)
    weights = parse_weights(args.objective, args.weight)
    params = effective_params(bench, args.set)
    start = read_rules(Path(args.start)) if args.start else None
    chosen = chosen_scenarios(args, bench, folder)
    max_A = min(driver_max_A(chosen), params["max_current_mA"] / 1000)
    if start is None:
        start = start_from_recipe(bench, folder, start_steadies(args, chosen), max_A, pool)
    return Task(
        scenarios=chosen,
        start=start,
        tune=tune,
        settings=method_settings(args.method, args.population, args.selection),
        objective=Objective(weights, max_A),
        seed=args.seed,
        limits=Limits(args.generations, args.evaluations),
        params=args.set,
        command=rerun_command(args),
    )


def rerun_command(args: argparse.Namespace) -> str:
    words = typed("quiesce rules optimize").split()
    for option in ("scenario", "weight", "set"):
        words += [word for value in getattr(args, option) for word in (f"--{option}", value)]
    for option in ("freq", "drive", "plant", "start", "population", "evaluations"):
        value = getattr(args, option)
        words += [] if value is None else [f"--{option}", str(value)]
    words += ["--settle", str(args.settle)] if args.freq else []
    for option in ("tune", "objective", "method", "selection", "generations", "seed"):
        words += [f"--{option}", str(getattr(args, option))]
    return shlex.join(words)


@contextmanager
def stopping_pool(bench: Bench, jobs: int):
    """Threads that wait for the bench; what runs is ended where the block raises."""
    pool = ThreadPoolExecutor(jobs)
    try:
        yield pool
    except BaseException:
        pool.shutdown(wait=False, cancel_futures=True)
        bench.stop()
        raise
    finally:
        pool.shutdown()


def require_right_state(args: argparse.Namespace, state_file: Path) -> None:
    """What can be told about the state file before anything runs."""
    if args.resume and args.anew:
        raise UsageError("--resume and --anew exclude each other")
    if args.resume:
        optimize_state.read(state_file)
    generations = unfinished(state_file)
    if generations is not None and not args.resume and not args.anew:
        raise UsageError(
            f"{shown(state_file)} holds an unfinished search ({generations} generations); go on "
            "with --resume, drop it with --anew, or choose another --out"
        )


def interrupted(state_file: Path) -> int:
    generations = unfinished(state_file) if state_file.is_file() else None
    if generations is None:
        say("quiesce: interrupted; nothing was written")
    else:
        say(
            f"quiesce: interrupted; {generations} generations are in {shown(state_file)}, the same "
            "options and --resume go on"
        )
    return EXIT_INTERRUPTED


def search(args: argparse.Namespace, bench: Bench, state_file: Path) -> Found:
    with (
        tempfile.TemporaryDirectory(prefix="quiesce-") as folder,
        stopping_pool(bench, args.jobs) as pool,
    ):
        session = Session(bench, make_task(args, bench, Path(folder), pool), pool)
        state = session.state(state_file, args.resume)
        with output_files(state_file.parent):
            pass  # refuses a folder that cannot be written before the work
        return session.run(state, state_file)


def run(args: argparse.Namespace) -> int:
    bench = Bench()
    require_bench_option(bench)
    out = args.out or results_folder() / "report/rules_optimize"
    state_file = out / FILE_NAME
    require_right_state(args, state_file)
    try:
        found = search(args, bench, state_file)
    except KeyboardInterrupt:
        return interrupted(state_file)
    with output_files(out) as staging:
        write_report(found, staging)
    if args.json:
        print(json.dumps(result_json(found), indent=1))
    else:
        for title, text in text_sections(found):
            show(f"{title}\n\n{text}\n")
        print(f"{headline(found)}\nrules: {shown(out / 'best.fcl')}")
        print(f"report: {shown(out / 'report.html')}")
    return 0
