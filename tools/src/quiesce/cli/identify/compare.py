"""`quiesce identify compare MODEL.toml NEW.csv`: a damper model against new data."""

import argparse
import json
from pathlib import Path

from quiesce.base.errors import UsageError
from quiesce.base.paths import shown
from quiesce.cli.identify.data_options import add_data_options
from quiesce.cli.identify.help import fill
from quiesce.cli.terminal import show

NAME = "compare"
HELP = "score a model file on new data"
EPILOG = """The model runs free over the new tests; nothing is fitted. With --train and --test only
the test part is scored. Hints say which one constant (sign, scale, offset, shift in time) would
reduce the error a lot; they are not applied.

examples:
  quiesce identify compare damper.toml new.csv
  quiesce identify compare damper.toml new.csv --force Load:kN --json
"""


def add_options(parser: argparse.ArgumentParser) -> None:
    fill(parser, EPILOG)
    parser.add_argument("model", type=Path, metavar="MODEL.toml", help="damper file")
    parser.add_argument("files", nargs="+", type=Path, metavar="NEW.csv", help="recordings")
    parser.add_argument("--out", type=Path, metavar="FOLDER", help="write a page with plots there")
    parser.add_argument("--json", action="store_true", help="print one JSON object")
    add_data_options(parser.add_argument_group("data"))


def run(args: argparse.Namespace) -> int:
    from quiesce.cli.identify.data_options import records_of
    from quiesce.damper.compare import compare
    from quiesce.damper.data.split import split_records
    from quiesce.damper.report.comparison import numbers_of, text_of, write_page
    from quiesce.damper.report.runs import runs_of
    from quiesce.damper.simulate import simulator_of_file

    check_is_model(args.model)
    damper, simulate = simulator_of_file(args.model)
    data = records_of(args)
    train, test = split_records(data.records, data.split)
    found = compare(damper, runs_of(simulate, [], test or train))
    if args.out:
        write_page(args.out, args.model, found, data.notes)
    if args.json:
        print(json.dumps(numbers_of(found, data.notes), indent=1))
    else:
        show(text_of(args.model, found, data.notes))
        if args.out:
            print(f"\nwritten: {shown(args.out)}/compare.html")
    return 0


def check_is_model(file: Path) -> None:
    """The likeliest mistake is the order of the files."""
    if file.suffix.lower() == ".csv":
        raise UsageError(
            f"{shown(file)}: a damper file (.toml) comes first, then the data: "
            "quiesce identify compare MODEL.toml NEW.csv"
        )
    if not file.is_file():
        raise UsageError(f"{shown(file)}: no such file; name a damper file (TOML)")
