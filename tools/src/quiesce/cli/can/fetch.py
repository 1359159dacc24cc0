"""`quiesce can fetch law|tracker|learnt`: a table out of a controller, into a file."""

import argparse
import json
from pathlib import Path
from typing import Any

from quiesce.base.atomic import output_files
from quiesce.base.errors import UsageError
from quiesce.base.paths import shown
from quiesce.can.roads import ROADS
from quiesce.cli.can.bus_options import add_bus_options
from quiesce.cli.can.table_options import add_json, add_road, opened

EPILOG = """examples:
  quiesce can fetch law -o in_use.table --bus socketcan:can0
  quiesce can fetch learnt -o learnt.table --bus slcan:/dev/ttyACM0

What is in use, also a table that ships, or what has been learnt by now: a table's file, which
'quiesce can load' takes. Exit code 1 where there is none.
"""


def add_parser(commands: argparse._SubParsersAction) -> None:
    parser = commands.add_parser(
        "fetch",
        help="a table out of the controller",
        description="Fetch what the controller uses, or has learnt, into a table's file.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    add_road(parser, ROADS)
    parser.add_argument("-o", "--out", type=Path, required=True, metavar="FILE")
    add_json(parser)
    add_bus_options(parser)
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    check_out(args.out)
    with opened(args) as tables:
        report = fetched(tables, args.road, args.out)
    print(json.dumps(report, indent=1) if args.json else text(report))
    return 0


def check_out(file: Path) -> None:
    """UsageError, before anything is asked for, where it can be no file."""
    if file.is_dir():
        raise UsageError(f"{shown(file)}: a folder; name a file")


def fetched(tables: Any, road: str, file: Path) -> dict[str, Any]:
    """Writes it whole or not at all."""
    from quiesce.table.file import read_data
    from quiesce.table.kinds import kind_name

    data = tables.fetch(road)
    with output_files(file.parent) as staging:
        (staging / file.name).write_bytes(data)
    words = read_data(data).words
    return {
        "file": shown(file),
        "kind": kind_name(words[0]),
        "road": road,
        "words": len(words),
        "crc": f"{words[1]:08x}",
    }


def text(report: dict[str, Any]) -> str:
    return (
        f"{report['kind']}, {report['words']} words, CRC {report['crc']}: written to "
        f"{report['file']}"
    )
