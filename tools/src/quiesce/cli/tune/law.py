"""`quiesce tune law RECIPE`: settings of a published law, on an ensemble of records."""

import argparse
import json
import os
import shlex
from pathlib import Path

from quiesce.base.command import real_number, whole_number
from quiesce.base.errors import EXIT_INTERRUPTED, UsageError
from quiesce.base.paths import results_text, shown
from quiesce.cli.rig_options import (
    add_motions,
    add_rig,
    records_of,
    rig_files,
    shaking_of,
    words_of_motions,
)  # fmt: skip
from quiesce.cli.terminal import show
from quiesce.tune.gains.defaults import INDEX, TRIALS, WORST_WEIGHT

NAME = "law"
DESCRIPTION = """Tune a published law's settings on a structure over recorded motions: one search
and one number of trials for all laws."""

EPILOG = """examples:
  quiesce tune law skyhook_on_off --rig three_storeys_1996 --time-scale 5 --scale-to 3.417
  quiesce tune law clipped_optimal --rig three_storeys_1996 --time-scale 5 --scale-to 3.417 \\
      --tracker proportional --search force_1_N2=1e-14:1e-9 --out build/optimal
  quiesce tune law mixed_hooks --rig quarter_car --road C:72 --road D:54 --map map.table \\
      --figure tyre_share

One search for all laws: the first trial is the settings as they come (or as --fix says), a half of
the trials is spread evenly (Sobol), the rest is differential evolution from the best eight. Bounds
come from the recipe or from what the board's sensors reach; --search replaces them, or searches
any parameter of the controller, too. A tracker in proportion has its gain searched.

What is minimised is (mean + W x worst) / (1 + W) over the records, of the index of
`quiesce compare` or of --figure. Written to --out: RECIPE.toml (settings), RECIPE.table (table),
tune.html, tune.json, trials.jsonl. Ctrl-C keeps what was found; the same command goes on from it.
"""
MOST_TRIALS = 100_000


def add_options(parser: argparse.ArgumentParser) -> None:
    parser.epilog = EPILOG
    parser.formatter_class = argparse.RawDescriptionHelpFormatter
    parser.add_argument("recipe", metavar="RECIPE", help="one of `quiesce law list`")
    add_rig(parser)
    add_motions(parser)
    law = parser.add_argument_group("law")
    law.add_argument("--tracker", metavar="NAME", help="of forces (the recipe's)")
    law.add_argument("--map", type=Path, metavar="FILE", help="a damper's map, for tracker inverse")
    law.add_argument(
        "--fix", action="append", default=[], metavar="NAME=VALUE",
        help="a setting, or a parameter of the controller, that is not searched; may be repeated",
    )  # fmt: skip
    law.add_argument(
        "--search", action="append", default=[], metavar="NAME=LOW:HIGH",
        help="bounds of a setting or of a parameter; may be repeated",
    )  # fmt: skip
    aim = parser.add_argument_group("what to tune for, and how long")
    aim.add_argument(
        "--figure", default=INDEX, metavar="NAME",
        help="of `quiesce compare`, as weighted_m_s2 (%(default)s)",
    )  # fmt: skip
    aim.add_argument(
        "--worst", type=real_number(0.0, 1e6), default=WORST_WEIGHT, metavar="W",
        help="weight of the worst record beside the mean (%(default)s)",
    )  # fmt: skip
    aim.add_argument(
        "--trials", type=whole_number(1, MOST_TRIALS), default=TRIALS, metavar="N",
        help="runs over all records (%(default)s, the same for every law)",
    )  # fmt: skip
    aim.add_argument(
        "--seeds", type=whole_number(1, 1000), default=1, metavar="N",
        help="runs of each record with other noise (%(default)s)",
    )  # fmt: skip
    aim.add_argument(
        "--seed", type=whole_number(0, 2**31 - 1), default=1, metavar="N",
        help="of the search (%(default)s)",
    )  # fmt: skip
    parser.add_argument(
        "--jobs", type=whole_number(1, 1024), default=os.cpu_count() or 1, metavar="N",
        help="runs at a time; they change no result (%(default)s)",
    )  # fmt: skip
    parser.add_argument(
        "--out", type=Path, metavar="FOLDER", help=f"({results_text('tune/RECIPE_BOARD')})"
    )
    parser.add_argument("--fresh", action="store_true", help="give up trials that FOLDER holds")
    parser.add_argument("--json", action="store_true", help="print one JSON object")


def command(args: argparse.Namespace, shared: list[str]) -> str:
    """As it can be typed again, without what does not change the result."""
    words = ["quiesce", "tune", NAME, args.recipe, *shared]
    words += ["--tracker", args.tracker] if args.tracker else []
    words += ["--map", shown(args.map)] if args.map else []
    for name in ("fix", "search"):
        words += [word for value in getattr(args, name) for word in (f"--{name}", value)]
    words += ["--figure", args.figure, "--worst", f"{args.worst:g}", "--trials", str(args.trials)]
    words += ["--seeds", str(args.seeds), "--seed", str(args.seed)]
    words += ["--out", shown(args.out)] if args.out else []
    return shlex.join(words)


def run(args: argparse.Namespace) -> int:
    # Imported late: the options of `quiesce tune` need none of it.
    from quiesce.law.recipes import find
    from quiesce.tune.gains import report
    from quiesce.tune.gains import run as gains
    from quiesce.tune.gains.aim import Aim

    if args.out and args.out.exists() and not args.out.is_dir():
        raise UsageError(f"{shown(args.out)} is a file; name a folder for --out")
    plant, board = rig_files(args)
    shared = words_of_motions(args)
    tuned = gains.tune(
        gains.Order(
            recipe=find(args.recipe),
            plant=plant,
            board=board,
            records=records_of(args),
            shaking=shaking_of(args),
            seeds=args.seeds,
            tracker=args.tracker,
            map_file=args.map,
            fixed=args.fix,
            asked=args.search,
            aim=Aim(args.figure, args.worst),
            trials=args.trials,
            seed=args.seed,
            jobs=args.jobs,
            out=args.out,
            is_fresh=args.fresh,
            command=command(args, shared),
            shared=shared,
        )
    )
    report.write(tuned)
    show(json.dumps(report.data_of(tuned), indent=1) if args.json else report.text(tuned))
    return EXIT_INTERRUPTED if tuned.is_interrupted else 0
