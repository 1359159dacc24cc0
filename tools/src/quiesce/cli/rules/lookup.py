"""`quiesce rules lookup`: constant currents swept; the paper's Table VII and the rules from it."""

import argparse
import json
import os
import tempfile
from pathlib import Path

from quiesce.base.atomic import output_files
from quiesce.base.command import whole_number
from quiesce.base.errors import UsageError
from quiesce.base.paths import shown
from quiesce.cli.rules.arguments import add_settle, drives_V, freqs_Hz
from quiesce.cli.rules.optimize import stopping_pool
from quiesce.cli.terminal import show
from quiesce.engine.bench import Bench
from quiesce.engine.params import effective_params
from quiesce.rules.formats.files import write_text
from quiesce.rules.optimize.evaluate import ClosedLoop, driver_max_A
from quiesce.rules.optimize.lookup import Sweep, lookup_json, lookup_table, sweep
from quiesce.rules.optimize.result import rule_table, set_lines
from quiesce.rules.optimize.scenarios import plant_file, steady_scenarios
from quiesce.rules.optimize.start import recipe_base

FREQS, DRIVES = "5,10,15,20", "0.09,0.1,0.12"
STEP_mA = 250

EPILOG = """examples:
  quiesce rules lookup                                    Table VII on the published plant
  quiesce rules lookup --freq 4,6,8,10 --step-mA 100
  quiesce rules lookup --plant my_plant.toml --freq 3,5,8 --drive 0.5 --write my_rules.fcl

The rule base has a frequency set for every frequency, four RMS sets, and for each frequency the
output term nearest to the current of least RMS acceleration, the mean over the drives: the recipe
of the squeeze-mode paper. It is where 'quiesce rules optimize' starts.
"""


def add_parser(commands: argparse._SubParsersAction) -> None:
    parser = commands.add_parser(
        "lookup",
        help="the constant current of least RMS acceleration, by frequency and drive",
        description="Sweep constant currents over steady vibration and print, for every frequency\n"
        "and drive, the one of least RMS acceleration, and the rules that follow from it.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--freq", metavar="HZ,...", default=FREQS, help="(%(default)s)")
    parser.add_argument("--drive", metavar="V,...", default=DRIVES, help="(%(default)s)")
    parser.add_argument("--plant", metavar="FILE", help="plant file (squeeze_2012.toml)")
    add_settle(parser)
    parser.add_argument(
        "--step-mA", type=whole_number(1, 20000), default=STEP_mA, metavar="N",
        help="of the currents (%(default)s)",
    )  # fmt: skip
    parser.add_argument(
        "--set", metavar="NAME=VALUE", action="append", default=[],
        help="parameter for every run, repeatable",
    )  # fmt: skip
    parser.add_argument("--write", type=Path, metavar="FILE", help="write the rules, as FCL")
    parser.add_argument(
        "--jobs", type=whole_number(1, 256), default=os.cpu_count() or 1, metavar="N",
        help="closed-loop runs at once (%(default)s)",
    )  # fmt: skip
    parser.add_argument("--json", action="store_true", help="print JSON")
    parser.set_defaults(run=run)


def measure(args: argparse.Namespace, bench: Bench) -> tuple[Sweep, float]:
    """The sweep, and the largest current."""
    freqs, drives = freqs_Hz(args.freq), drives_V(args.drive)
    params = effective_params(bench, args.set)
    with (
        tempfile.TemporaryDirectory(prefix="quiesce-") as folder,
        stopping_pool(bench, args.jobs) as pool,
    ):
        plant = plant_file(args.plant)
        chosen = steady_scenarios(bench, Path(folder), plant, freqs, drives, args.settle)
        max_A = min(driver_max_A(chosen), params["max_current_mA"] / 1000)
        loop = ClosedLoop(bench, chosen, args.set)
        return sweep(loop, round(1000 * max_A), args.step_mA, pool), max_A


def run(args: argparse.Namespace) -> int:
    if args.write and not args.write.resolve().parent.is_dir():
        raise UsageError(f"--write {args.write}: its folder does not exist")
    found, max_A = measure(args, Bench())
    if args.json:
        print(json.dumps(lookup_json(found), indent=1))
    else:
        show(f"Table VII: constant current of least RMS acceleration\n\n{lookup_table(found)}")
    if args.write or not args.json:
        write_rules(args, found, max_A)
    return 0


def write_rules(args: argparse.Namespace, found: Sweep, max_A: float) -> None:
    base = recipe_base(found, "recipe", max_A)
    if not args.json:
        show(f"\nTable VIII: the rules that follow\n\n{rule_table(base)}\n")
        print("\n".join(set_lines(base)))
    if args.write:
        with output_files(args.write.parent) as staging:
            (staging / args.write.name).write_text(write_text(base, "fcl"), encoding="utf-8")
        print(f"rules: {shown(args.write)}")
