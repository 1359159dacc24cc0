"""`quiesce rules convert FILE --to FORMAT`: a rule file in another format, without silent loss."""

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from quiesce.base.atomic import output_files
from quiesce.base.errors import UsageError
from quiesce.rules.formats.build import NotPlain
from quiesce.rules.formats.files import (
    FORMATS,
    format_of,
    read_rules,
    read_system,
    write_system,
    write_text,
)

EPILOG = """examples:
  quiesce rules convert tools/benchmarks/rules/reference_centroid.fcl --to fll
  quiesce rules convert controller.fis --to fcl --out controller.fcl
  quiesce rules convert smooth.fis --to fcl --approximate 8
  quiesce rules convert smooth.fis --to fll --out smooth.fll

A file that is no plain rule base (other norms, smooth sets, hedges, values that depend on inputs)
is written as it is, and must answer the same when it is read again. FLL holds nearly all of it;
FCL has no resolution; FIS has one block of plain rules, and no default.
T2FIS (sets of type 2) is read and not written: its rules stand twice in the other format.
What the target format cannot hold is an error that names it. Notes go to stderr: what was
approximated, with the largest error of each set, and what was taken for granted.
"""


def add_parser(commands: argparse._SubParsersAction) -> None:
    parser = commands.add_parser(
        "convert",
        help="a rule file in another format",
        description="Read a rule file (.fcl, .fll, .fis, .t2fis) and write it in another format.",
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
    text, notes = converted(args)
    for note in notes:
        print(note, file=sys.stderr)
    if args.out is None:
        print(text, end="")
        return 0
    with output_files(args.out.resolve().parent) as staging:
        (staging / args.out.name).write_text(text, encoding="utf-8")
    return 0


def converted(args: argparse.Namespace) -> tuple[str, Sequence[str]]:
    """Of a plain base, or of any other system, with notes, each with its file."""
    name = args.file
    try:
        base = read_rules(name, args.approximate)
    except NotPlain as reason:
        if args.approximate is not None:
            raise
        system = read_system(name)
        text = write_system(system, args.to)
        return text, [f"written as it is, as {reason}", *(f"{name}: {one}" for one in system.notes)]
    return write_text(base, args.to), [f"{name}: {note}" for note in base.notes]
