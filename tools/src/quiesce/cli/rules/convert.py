"""`quiesce rules convert FILE --to FORMAT`: a rule file in another format, without silent loss."""

import argparse
import sys
from pathlib import Path

from quiesce.base.atomic import output_files
from quiesce.base.errors import UsageError
from quiesce.rules.formats.files import FORMATS, format_of, read_rules, write_text

EPILOG = """examples:
  quiesce rules convert tools/benchmarks/rules/reference_centroid.fcl --to fll
  quiesce rules convert controller.fis --to fcl --out controller.fcl
  quiesce rules convert smooth.fis --to fcl --approximate 8

What the target format cannot hold is an error that names it. Notes go to stderr: what was
approximated, with the largest error of each set, and what was taken for granted.
"""


def add_parser(commands: argparse._SubParsersAction) -> None:
    parser = commands.add_parser(
        "convert",
        help="a rule file in another format",
        description="Read a rule file (.fcl, .fll, .fis) and write it in one of these formats.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("file", metavar="FILE", type=Path, help="rule file")
    parser.add_argument("--to", choices=FORMATS, required=True, help="the format to write")
    parser.add_argument("--out", type=Path, metavar="FILE", help="file to write (stdout)")
    parser.add_argument(
        "--approximate",
        type=int,
        metavar="N",
        help="take a chain of N straight segments for each Gaussian or other smooth set",
    )
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    if args.out and format_of(args.out) != args.to:
        raise UsageError(f"--out {args.out}: a file of --to {args.to} ends in .{args.to}")
    base = read_rules(args.file, args.approximate)
    text = write_text(base, args.to)
    for note in base.notes:
        print(f"{args.file}: {note}", file=sys.stderr)
    if args.out is None:
        print(text, end="")
        return 0
    with output_files(args.out.resolve().parent) as staging:
        (staging / args.out.name).write_text(text, encoding="utf-8")
    return 0
