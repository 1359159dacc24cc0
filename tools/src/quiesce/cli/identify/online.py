"""`quiesce identify online FILE...`: a model that adapts beside frozen ones, over a change."""

import argparse
import json
import os
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

from quiesce.base.command import real_number, whole_number
from quiesce.base.errors import UsageError
from quiesce.base.paths import shown
from quiesce.cli.identify.data_options import add_data_options
from quiesce.cli.identify.help import fill
from quiesce.cli.terminal import show

NAME = "online"
HELP = "a model that adapts sample by sample, beside frozen ones"
EPILOG = """Streams the recordings, one after the other, past the self-tuning fuzzy model, which
adapts after every sample. Beside it run models that were fitted to what precedes a change (of
current, temperature or damper) and are frozen then. The change is where the second file begins or
the current first leaves its level, unless --change-s states it. Errors are told before it, in the
first --settle-s after it, and from then on. --out writes online.html and adapted.toml, the
adaptive model as it is at the end.

The adaptive model is told every measured force, the others are not: an estimator beside
predictions. "the last force" is what holding the force of the sample before would give.

examples:
  quiesce identify online example.csv --out build/online
  quiesce identify online cold.csv warm.csv
  quiesce identify online rig.csv --change-s 12.5 --model kwok_tanh,viscoplastic_1 --json
"""


def add_options(parser: argparse.ArgumentParser) -> None:
    fill(parser, EPILOG)
    parser.add_argument("files", nargs="+", type=Path, metavar="FILE.csv", help="recordings")
    parser.add_argument(
        "--change-s", type=real_number(0.0, 1e6, "a time in s"), metavar="s",
        help="time of the change from the first row on",
    )  # fmt: skip
    parser.add_argument(
        "--settle-s", type=real_number(0.0, 1e4, "a time in s"), default=2.0, metavar="s",
        help="that the adaptive model is given (%(default)g)",
    )  # fmt: skip
    parser.add_argument(
        "--model", default=None, metavar="NAMES",
        help="models to fit and to freeze (bingham,kwok_bouc_wen,kwok_tanh); see identify --help",
    )  # fmt: skip
    parser.add_argument(
        "--beside", action="append", default=[], type=Path, metavar="MODEL.toml",
        help="a damper file that runs beside them as it is; repeatable",
    )  # fmt: skip
    parser.add_argument(
        "--rates", default=None, metavar="OUT,CENTRE,BASE",
        help="learning rates of outputs, centres and bases, 0 .. 2 (0.5,0.1,0.1)",
    )  # fmt: skip
    parser.add_argument("--effort", choices=("quick", "full"), default="quick", help="of the fits")
    parser.add_argument(
        "--seed", type=whole_number(0, 2**31), default=1, metavar="N", help="(%(default)s)"
    )
    parser.add_argument("--out", type=Path, metavar="FOLDER", help="write page and model there")
    parser.add_argument("--json", action="store_true", help="print one JSON object")
    add_data_options(parser.add_argument_group("data"))


def run(args: argparse.Namespace) -> int:
    from quiesce.base.progress import say
    from quiesce.cli.identify.data_options import records_of
    from quiesce.damper.candidates import names_of
    from quiesce.damper.online import FROZEN, RATES, follow, model_of, stream_of
    from quiesce.damper.report.online import MODEL, PAGE, numbers_of, text_of, write_page
    from quiesce.damper.task import Plan

    if args.part_train is not None or args.part_test is not None:
        raise UsageError("--train and --test: the change divides the rows here; see --change-s")
    names = list(FROZEN) if args.model is None else names_of(args.model)
    rates = RATES if args.rates is None else rates_of(args.rates)
    beside = [(name, simulator_of(one)) for name, one in named(args.beside)]
    data = records_of(args)
    stream = stream_of(data.records, args.change_s, args.settle_s)
    plan = Plan(names, seed=args.seed, quick=args.effort == "quick", jobs=os.cpu_count() or 1)
    found = follow(stream, plan, args.settle_s, rates, beside, say)
    if args.out:
        title, command = args.files[0].stem, "quiesce " + " ".join(sys.argv[1:])
        adapted = model_of(found.end, stream.before(), f"{title}_adapted")
        write_page(args.out, title, command, found, adapted, data.notes)
    numbers = numbers_of(found, data.notes)
    show(json.dumps(numbers, indent=1) if args.json else text_of(found, data.notes))
    if args.out and not args.json:
        print(f"\nwritten: {shown(args.out)}/{PAGE}, {MODEL}")
    return 0


def named(files: list[Path]) -> list[tuple[str, Path]]:
    """By their names, by their paths where those are equal. No model has a name that ends so."""
    names = [one.name for one in files]
    found = [
        (name if names.count(name) == 1 else shown(one), one)
        for name, one in zip(names, files, strict=True)
    ]
    if len(dict(found)) < len(found):
        raise UsageError("--beside: a file is named twice")
    return found


def simulator_of(file: Path) -> Any:
    from quiesce.cli.identify.compare import check_is_model
    from quiesce.damper.simulate import simulator_of_file

    check_is_model(file)
    return simulator_of_file(file)[1]


def rates_of(text: str) -> Any:
    from quiesce.damper.online import RATES

    try:
        values = [float(word) for word in text.split(",")]
    except ValueError:
        values = []
    if len(values) != 3 or not all(0.0 <= value <= 2.0 for value in values):
        raise UsageError(f"--rates '{text}': three numbers in 0 .. 2, such as 0.5,0.1,0.1")
    output, centre, base = values
    return replace(RATES, output=output, centre=centre, base=base)
