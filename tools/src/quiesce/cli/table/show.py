"""`quiesce table show FILE`: what a table file is, and what it says."""

import argparse
import json
from pathlib import Path
from typing import Any

from quiesce.base.atomic import output_files
from quiesce.base.errors import UsageError
from quiesce.base.paths import shown
from quiesce.base.table import format_pairs
from quiesce.cli.table.contents import board_text, contents_of, kind_of, kind_text
from quiesce.cli.terminal import show
from quiesce.table.file import TableFile, read_file
from quiesce.table.kinds import PULSES, ROADS, Kind
from quiesce.table.words import MOST_WORDS, WORD_BYTES

EPILOG = """examples:
  quiesce table show build/laws/skyhook.table
  quiesce table show build/tune/frame/frame.phase.table --plot build/pulses.svg
  quiesce table show map.table --json

Bodies and dampers are numbered as on the board, from 1. Gains are those of the integers that the
controller works with.
"""
ENDINGS = (".svg", ".png", ".pdf")


def add_parser(actions: argparse._SubParsersAction) -> None:
    parser = actions.add_parser(
        "show",
        help="what a table file is and what it says, in SI units",
        description="Show a table file: kind, size, CRC, board, who takes it, and what it says.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("file", type=Path, metavar="FILE", help="table file")
    parser.add_argument(
        "--plot", type=Path, metavar="FILE", help=f"draw it (pulses): {', '.join(ENDINGS)}"
    )
    parser.add_argument("--json", action="store_true", help="print one JSON object")
    parser.set_defaults(run=run)


def takers(kind: Kind | None) -> str:
    if kind is None:
        return "not known"
    told = [f"law {one}" for one in kind.laws] + [f"tracker {one}" for one in kind.trackers]
    return ", ".join(told)


def head_text(file: Path, table: TableFile) -> str:
    kind = kind_of(table.words)
    count = len(table.words)
    rows = {
        "file": shown(file),
        "kind": kind_text(table.words),
        "road": f"{kind.road}, {ROADS[kind.road]}" if kind else "not known",
        "taken by": takers(kind),
        "size": f"{count} words, {WORD_BYTES * count} of {WORD_BYTES * MOST_WORDS} bytes",
        "CRC-32": f"0x{table.words[1]:08x}",
        "board": board_text(table.board),
    }
    return format_pairs(rows)


def data_of(table: TableFile, contents: str) -> dict[str, Any]:
    kind = kind_of(table.words)
    count = len(table.words)
    return {
        "kind": kind.name if kind else None,
        "version": kind.version if kind else None,
        "road": kind.road if kind else None,
        "laws": kind.laws if kind else [],
        "trackers": kind.trackers if kind else [],
        "magic": table.words[0],
        "crc32": table.words[1],
        "board": table.board,
        "words": count,
        "bytes": WORD_BYTES * count,
        "most_bytes": WORD_BYTES * MOST_WORDS,
        "contents": contents.splitlines(),
    }


def plot(table: TableFile, out: Path) -> None:
    """UsageError where there is no picture of its kind."""
    if kind_of(table.words) != PULSES:
        raise UsageError(f"--plot: there is no picture of {kind_text(table.words)}; of pulses only")
    if out.suffix.lower() not in ENDINGS:
        raise UsageError(f"--plot {out}: expected a name that ends in {', '.join(ENDINGS)}")
    from quiesce.report.plot_style import pyplot
    from quiesce.tune.phase_words import law_of_words
    from quiesce.tune.plots import plot_pulses

    figure = plot_pulses(law_of_words(table.words))
    with output_files(out.parent) as folder:
        figure.savefig(folder / out.name)
    pyplot().close(figure)


def run(args: argparse.Namespace) -> int:
    table = read_file(args.file)
    contents = contents_of(args.file, table)
    if args.plot:
        plot(table, args.plot)
    if args.json:
        print(json.dumps(data_of(table, contents), indent=1))
        return 0
    show("\n\n".join(filter(None, [head_text(args.file, table), contents])))
    if args.plot:
        print(f"\nwritten    {shown(args.plot)}")
    return 0
