"""`quiesce can load KIND FILE`: a table into a controller at work."""

import argparse
import json
from pathlib import Path
from typing import Any

from quiesce.base.paths import shown
from quiesce.can.roads import LEARNT
from quiesce.cli.can.bus_options import add_bus_options
from quiesce.cli.can.table_options import add_json, opened, step
from quiesce.loading.sources import WORDS, Table, table_of

EPILOG = """examples:
  quiesce can load rules mine.fis --bus socketcan:can0
  quiesce can load pulses build/tune/mine --save --bus slcan:/dev/ttyACM0
  quiesce can load law clipped.table --dry-run --bus socketcan:can0
  quiesce can load tracker damper.table --bus socketcan:can0

KIND: rules (a rule file .fis, .fll, .fcl or .t2fis, compiled for the controller, or a table),
pulses (what 'quiesce tune' wrote: its folder, the NAME.phase.toml in it, or a table), law (any
table of a law), tracker (map, bank or network of a damper), learnt (what 'quiesce can fetch
learnt' wrote). A table's file is named .table.

The table is sent whole, checked by the controller, then used from one tick to the next, also while
it runs; the slew limits what the current does then. What is refused changes nothing. --dry-run asks
for the verdict alone. Without --save the next start has what it had.
Exit codes: 1 the controller refused or did not answer, 2 no such table, nothing was sent.
"""


def add_parser(commands: argparse._SubParsersAction) -> None:
    parser = commands.add_parser(
        "load",
        help="a table: rules, pulses, a damper's map, ..",
        description="Load a table into a controller at work: all of it, checked, or nothing.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("kind", choices=WORDS, metavar="KIND", help=", ".join(WORDS))
    parser.add_argument("file", type=Path, metavar="FILE")
    parser.add_argument("--save", action="store_true", help="use it after the next start, too")
    parser.add_argument("--dry-run", action="store_true", help="check only, use nothing")
    add_json(parser)
    add_bus_options(parser)
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    from quiesce.loading.load import put, save

    table = table_of(args.kind, args.file)
    for note in table.notes:
        step(f"{shown(args.file)}: {note}")
    with opened(args) as tables:
        took_s = put(tables, table, step, not args.dry_run)
        is_saved = args.save and not args.dry_run
        if is_saved:
            save(tables, table)
    report = report_of(args, table, took_s, is_saved)
    print(json.dumps(report, indent=1) if args.json else text(report))
    return 0


def report_of(
    args: argparse.Namespace, table: Table, took_s: float, is_saved: bool
) -> dict[str, Any]:
    return {
        "file": shown(args.file),
        "kind": table.kind.name,
        "road": table.road,
        "words": len(table.words),
        "crc": f"{table.crc:08x}",
        "took_s": round(took_s, 3),
        "is_in_use": not args.dry_run,
        "is_saved": is_saved,
    }


def text(report: dict[str, Any]) -> str:
    head = f"{report['kind']}, {report['words']} words, CRC {report['crc']}"
    lines = [f"table   {head}, of {report['file']}"]
    if not report["is_in_use"]:
        return "\n".join([*lines, "verdict the controller would take it; nothing was changed"])
    back = "forget-learnt" if report["road"] == LEARNT else f"revert {report['road']}"
    stored = (
        "for the next start"
        if report["is_saved"]
        else "no: the next start has what it had; --save stores it"
    )
    lines += [
        f"in use  on road {report['road']}, after {report['took_s']:.1f} s",
        f"stored  {stored}",
        f"back    quiesce can {back}",
    ]
    return "\n".join(lines)
