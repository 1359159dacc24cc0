"""`quiesce tune`: pulses of current for a plant, and what they are worth."""

import argparse
import json
import os
import shlex
import sys
from collections.abc import Sequence
from pathlib import Path

from quiesce.base.command import finite_number, whole_number
from quiesce.base.errors import EXIT_INTERRUPTED, UsageError
from quiesce.base.paths import results_text, shown
from quiesce.cli.terminal import show
from quiesce.cli.tune import law

NAME = "tune"
LAW = f"{NAME}-{law.NAME}"

EPILOG = """also:
  quiesce tune law RECIPE                       settings of a published law, on recorded motions
  ('quiesce tune law --help' has its options)

examples:
  quiesce tune my_plant.toml --quick            a first look: 7 frequencies
  quiesce tune my_plant.toml --out my_law       all of it: minutes, can be interrupted
  quiesce tune --from-sweep recording.csv       identify the plant first, then tune for it
  quiesce tune my_plant.toml --weights balanced=1,2,0.1
  quiesce tune my_plant.toml --accel-limit displacement=120

Writes NAME.phase.toml (the law file), NAME.phase.table (the table, for 'quiesce_bench run
--pulses' and for a controller), NAME.set (parameters as --set words), report.html, the
plots, tune.json and work.json (finished pieces: an interrupted run goes on from there).

A law has two settings, 'displacement' and 'balanced'; --weights replaces what one of them wants
with DISPLACEMENT, ACCELERATION and CURRENT: what is minimised is the sum of weight times
displacement (half peak-to-peak over that at 0 A), weight times RMS acceleration (over that at 0 A)
and weight times mean current (over full current). Own weights have no limits but --accel-limit.
"""


def words_of(arguments: Sequence[str]) -> list[str]:
    """`tune law ...` as the one word that the parser knows."""
    words = list(arguments)
    return [LAW, *words[2:]] if words[:2] == [NAME, law.NAME] else words


def add_parser(commands: argparse._SubParsersAction) -> None:
    add_law(commands)
    parser = commands.add_parser(
        NAME,
        description="Compute the phase law's pulses for a plant, and what they are worth.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("plant", type=Path, nargs="?", metavar="PLANT.toml")
    parser.add_argument(
        "--out", type=Path, metavar="DIR", help=f"folder to write to ({results_text('tune/NAME')})"
    )
    parser.add_argument("--quick", action="store_true", help="few frequencies, coarser bounds")
    parser.add_argument("--json", action="store_true", help="print the figures as one JSON object")
    parser.add_argument(
        "--jobs", type=whole_number(1, 1024), default=os.cpu_count() or 1, metavar="N",
        help="processes (%(default)s)",
    )  # fmt: skip
    parser.add_argument("--fresh", action="store_true", help="give up what DIR holds already")
    add_aims(parser.add_argument_group("what to tune for"))
    add_sources(parser.add_argument_group("the plant from a recording"))
    parser.set_defaults(run=run)


def add_law(commands: argparse._SubParsersAction) -> None:
    parser = commands.add_parser(LAW, prog="quiesce tune law", description=law.DESCRIPTION)
    law.add_options(parser)
    parser.set_defaults(run=law.run)


def add_aims(group: argparse._ArgumentGroup) -> None:
    group.add_argument(
        "--weights", action="append", default=[], metavar="SETTING=D,A,C",
        help="weights of displacement, acceleration, current; repeatable (the shipped settings)",
    )  # fmt: skip
    group.add_argument(
        "--accel-limit", action="append", default=[], metavar="SETTING=PERCENT",
        help="most RMS acceleration, of that at 0 A; repeatable",
    )  # fmt: skip
    for name, text in (
        ("--from-Hz", "first frequency (0.35 times the first mode; with --quick 0.45)"),
        ("--to-Hz", "last frequency (2 times the first mode)"),
        ("--step-Hz", "step; 2 to 64 frequencies in all (some 40; with --quick 7)"),
    ):
        group.add_argument(name, type=finite_number, metavar="Hz", help=text)
    group.add_argument(
        "--robustness", choices=("none", "axes", "full"), default="axes",
        help="other plants to try: one property changed at a time, or all 81 combinations "
        "(%(default)s)",
    )  # fmt: skip
    group.add_argument(
        "--no-closed-loop", action="store_true",
        help="leave the simulated firmware out: steady state of the table only",
    )  # fmt: skip


def add_sources(group: argparse._ArgumentGroup) -> None:
    group.add_argument("--from-sweep", type=Path, metavar="FILE.csv", help="identify it from this")
    group.add_argument(
        "--base-plant", type=Path, metavar="PLANT.toml",
        help="your sensor, driver, damper model and geometry (squeeze_2012)",
    )  # fmt: skip
    group.add_argument(
        "--modal-mass", type=finite_number, default=1.0, metavar="kg",
        help="of the first mode at the sensor (%(default)g)",
    )  # fmt: skip
    group.add_argument(
        "--damper-elsewhere", action="store_true", help="the damper does not act at the sensor"
    )
    group.add_argument(
        "--modes", type=whole_number(1, 1024), metavar="N", help="modes in the band (found)"
    )


def check(args: argparse.Namespace) -> None:
    if (args.plant is None) == (args.from_sweep is None):
        raise UsageError("name a plant file, or a recording with --from-sweep; one of them")
    if args.from_sweep is None and (args.base_plant or args.damper_elsewhere or args.modes):
        raise UsageError("--base-plant, --damper-elsewhere and --modes go with --from-sweep")
    if args.modal_mass <= 0.0:
        raise UsageError("--modal-mass: expected more than 0 kg")
    if args.out and args.out.exists() and not args.out.is_dir():
        raise UsageError(f"{shown(args.out)} is a file; name a folder for --out")


def what_was_asked(args: argparse.Namespace) -> str:
    """As it can be typed again, without what does not change the result."""
    words = ["quiesce", "tune"]
    words += [shown(args.plant)] if args.plant else ["--from-sweep", shown(args.from_sweep)]
    for name in ("base_plant", "modes", "from_Hz", "to_Hz", "step_Hz"):
        if (value := getattr(args, name)) is not None:
            value = shown(value) if isinstance(value, Path) else f"{value:g}"
            words += [f"--{name.replace('_', '-')}", value]
    for name in ("weights", "accel_limit"):
        for value in getattr(args, name):
            words += [f"--{name.replace('_', '-')}", value]
    flags = ("quick", "damper_elsewhere", "no_closed_loop")
    words += [f"--{name.replace('_', '-')}" for name in flags if getattr(args, name)]
    words += ["--modal-mass", f"{args.modal_mass:g}"] if args.modal_mass != 1.0 else []
    words += ["--robustness", args.robustness] if args.robustness != "axes" else []
    return shlex.join(words)


def tune_into(args: argparse.Namespace) -> int:
    # Imported late: scipy and matplotlib are slow, and most commands need neither.
    from quiesce.tune import run as tune

    source = tune.Source(
        args.plant, args.from_sweep, args.base_plant, args.modal_mass,
        not args.damper_elsewhere, args.modes,
    )  # fmt: skip
    tuned = tune.tune(
        tune.Order(
            source=source,
            out=args.out,
            asked=what_was_asked(args),
            band=tune.Band(args.from_Hz, args.to_Hz, args.step_Hz),
            settings=tune.chosen_settings(args.weights, args.accel_limit),
            robustness=args.robustness,
            is_quick=args.quick,
            is_fresh=args.fresh,
            has_closed_loop=not args.no_closed_loop,
            jobs=args.jobs,
        )
    )
    show(json.dumps(tuned.json(), indent=1) if args.json else tuned.text())
    return 0


def run(args: argparse.Namespace) -> int:
    check(args)
    try:
        return tune_into(args)
    except KeyboardInterrupt:
        print(
            "quiesce: interrupted; the same command goes on with the pieces that are finished",
            file=sys.stderr,
        )
        return EXIT_INTERRUPTED
