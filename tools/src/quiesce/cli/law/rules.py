"""`quiesce law rules FILE`: a rule file over a board's signals as a table."""

import argparse
import json
from pathlib import Path

from quiesce.base.atomic import output_files
from quiesce.base.command import real_number
from quiesce.base.errors import UsageError
from quiesce.base.paths import shown
from quiesce.engine.bench import Bench
from quiesce.law.forms.fuzzy_signals import FuzzySignalsTable
from quiesce.law.from_rules import sources_of, table_of_rules
from quiesce.law.rig import load_rig
from quiesce.rules.formats.files import MAX_SEGMENTS, read_rules
from quiesce.rules.model import RuleBase
from quiesce.table.file import table_bytes

EPILOG = """examples:
  quiesce law rules my.fis --board my_board.toml --map "vel=velocity of third" -o build/my.table
  quiesce law rules my.fcl --board my_board.toml --map "drift=1000 |stroke|" --output-A 0.5 \\
      -o build/my.table

FCL, FLL or FIS with one output, a current. A signal is a quantity of the board in SI units:
acceleration, velocity, displacement (of a body), stroke, stroke velocity, force (of a damper) and
so on. Without a place it is each damper's own, and of a body that at the damper's end `from`. A
number before it makes the file's units of SI units; between bars it is its magnitude. An input
that no --map names is the signal of its own name, with a blank for _. Sugeno's terms of first order
are taken as they are.
"""


def add_parser(actions: argparse._SubParsersAction) -> None:
    parser = actions.add_parser(
        "rules",
        help="a rule file of your own as a table for a board",
        description="Make the table of law fuzzy_signals of a rule file: fuzzy rules over any "
        "signals of a board, for each damper by itself.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("file", type=Path, metavar="FILE", help="rules: .fcl, .fll or .fis")
    parser.add_argument("--board", type=Path, required=True, metavar="FILE", help="board, TOML")
    parser.add_argument(
        "--map", action="append", default=[], metavar="NAME=SIGNAL",
        help="what an input is: [FACTOR] QUANTITY [of PLACE]",
    )  # fmt: skip
    parser.add_argument(
        "--output-A", type=real_number(1e-6, 1e6), default=1.0, metavar="A",
        help="current for 1 of the file's output (%(default)g)",
    )  # fmt: skip
    parser.add_argument(
        "--approximate", type=int, metavar="N",
        help=f"take chains of N straight segments for smooth sets, 2 .. {MAX_SEGMENTS}",
    )  # fmt: skip
    parser.add_argument("-o", "--out", type=Path, required=True, metavar="FILE", help="the table")
    parser.add_argument("--json", action="store_true", help="print one JSON object")
    parser.set_defaults(run=run)


def made(args: argparse.Namespace) -> tuple[RuleBase, FuzzySignalsTable, list[int], int]:
    """With the table's words and the board's CRC-32."""
    base = read_rules(args.file, args.approximate, first_order=True)
    rig = load_rig(Bench(), args.board, None, 1000)
    try:
        table = table_of_rules(rig, base, sources_of(rig, base, args.map), args.output_A)
        return base, table, table.words(), rig.board_crc32
    except ValueError as error:
        raise UsageError(f"{shown(args.file)}: {error}")


def run(args: argparse.Namespace) -> int:
    base, table, words, board = made(args)
    with output_files(args.out.parent) as folder:
        (folder / args.out.name).write_bytes(table_bytes(words, board))
    signals = [one.name for one in table.signals()]
    if args.json:
        told = {"rules": len(base.rules), "signals": signals, "law": table.law, "words": len(words)}
        print(json.dumps({**told, "notes": list(base.notes)}, indent=2))
        return 0
    lines = [f"{base.name}: {len(words)} words for law {table.law}, {shown(args.out)}"]
    lines += [f"note       {note}" for note in base.notes]
    lines.append(
        f"run it     quiesce_bench run --scenario FILE --board {shown(args.board)} --law "
        f"{table.law} --law-table {shown(args.out)}"
    )
    print("\n".join(lines))
    return 0
