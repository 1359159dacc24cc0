"""`quiesce can tables`: which tables a controller uses, and where they came from."""

import argparse
import json
from operator import itemgetter
from typing import Any

from quiesce.base.table import format_table
from quiesce.cli.can.bus_options import add_bus_options
from quiesce.cli.can.table_options import add_json, opened
from quiesce.cli.terminal import show

EPILOG = """examples:
  quiesce can tables --bus socketcan:can0
  quiesce can tables --json --bus slcan:/dev/ttyACM0

A row a road: the law's table, the tracker's, what was learnt. from: ships (compiled in), loaded
(over CAN), stored (of an earlier start), file (the configuration's). stored: CRC of what the next
start has. writes: how often the record of that road was written. Below, the last refusal,
and a record that this start found damaged.
"""


def add_parser(commands: argparse._SubParsersAction) -> None:
    parser = commands.add_parser(
        "tables",
        help="which tables are in use and stored",
        description="Tell which tables the controller uses, and where they came from.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    add_json(parser)
    add_bus_options(parser)
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    from quiesce.can.roads import ROADS
    from quiesce.can.tables import BOARD

    with opened(args) as tables:
        board = tables.info(ROADS[0], BOARD)
        states = [tables.state(road) for road in ROADS]
    report = {"board": word(board), "roads": [row_of(state) for state in states]}
    show(json.dumps(report, indent=1) if args.json else text(report))
    return 0


def word(value: int) -> str | None:
    return f"{value:08x}" if value else None


def row_of(state: Any) -> dict[str, Any]:
    from quiesce.can.refusals import verdict_of
    from quiesce.table.kinds import kind_name

    refusal = verdict_of(state.refusal) if state.refusal else None
    return {
        "road": state.road,
        "kind": kind_name(state.magic),
        "crc": word(state.crc),
        "source": state.source,
        "stored_crc": word(state.stored_crc),
        "writes": state.writes,
        "refusal": refusal and {"verdict": refusal.label, "why": refusal.text},
        "record": state.record,
    }


# Of records that are not whole.
FOUND = {
    "older": "a copy is damaged, or was cut off: perhaps the one before is in use; save it again",
    "lost": "damaged, or of another board, and not used",
}


def text(report: dict[str, Any]) -> str:
    rows = map(itemgetter("road", "kind", "crc", "source", "stored_crc", "writes"), report["roads"])
    head = ["road", "in use", "CRC", "from", "stored", "writes"]
    lines = [format_table(head, rows, left=range(5))]
    lines += [
        f"last refusal on road {one['road']}: {one['refusal']['why']}"
        for one in report["roads"]
        if one["refusal"]
    ]
    lines += [
        f"record of road {one['road']}: {FOUND[one['record']]}"
        for one in report["roads"]
        if one["record"] in FOUND
    ]
    return "\n".join([*lines, f"board {report['board'] or 'none'}"])
