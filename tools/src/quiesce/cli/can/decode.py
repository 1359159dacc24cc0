"""`quiesce can decode FILE...`: logs as the signals of the shipped DBC."""

import argparse
import csv
import json
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

from quiesce.base.errors import EXIT_FAILED, UsageError
from quiesce.cli.can.options import add_database_option, add_only_option, database_of, ids_of

EPILOG = """examples:
  quiesce can decode drive.asc
  quiesce can decode run.blf --only Status,Motion --to csv > run.csv
  quiesce can decode run.mf4 --to jsonl | jq 'select(.message == "Status").signals.fault'

Reads .log (candump -L), .asc, .blf, .csv (of 'quiesce can record'), .mf4 and .trc. A frame that
cannot be trusted is shown with the reason: crc, repeated (its alive counter stood still), jumped
(frames before it are lost), length. Counts go to stderr; exit code 1 where a CRC or length was
wrong, 2 where a file is malformed (what comes before is printed).
"""

COLUMNS = ("time_s", "message", "signal", "value", "unit", "verdict")


def add_parser(commands: argparse._SubParsersAction) -> None:
    parser = commands.add_parser(
        "decode",
        help="logs as text, CSV or JSON lines",
        description="Decode CAN logs with the shipped DBC.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("files", type=Path, nargs="+", metavar="FILE")
    parser.add_argument(
        "--to", choices=tuple(WRITERS), default="text", help="what to print (%(default)s)"
    )
    add_only_option(parser)
    add_database_option(parser)
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    from quiesce.can.readers import check_log, read_log
    from quiesce.can.traffic import UNKNOWN, Traffic

    database = database_of(args)
    only = ids_of(args.only, database)
    for file in args.files:
        check_log(file)
    write = WRITERS[args.to]()
    is_right = True
    for file in args.files:
        traffic = Traffic(database)
        try:
            for frame in read_log(file):
                verdict = traffic.take(frame)
                if verdict != UNKNOWN and (only is None or frame.arbitration_id in only):
                    write(database, frame, verdict)
        except UsageError:
            if traffic.frames:
                tell(file, traffic)
            raise
        summary = tell(file, traffic)
        is_right = is_right and not (summary["wrong_crc"] or summary["wrong_length"])
    return 0 if is_right else EXIT_FAILED


def tell(file: Path, traffic: Any) -> dict[str, Any]:
    from quiesce.can.traffic import summary_line

    summary = traffic.summary()
    sys.stdout.flush()
    print(f"{file}: {summary_line(summary)}", file=sys.stderr)
    return summary


def signals_of(database: Any, frame: Any) -> dict[str, Any]:
    """Empty where the length is not the message's, or it has no such page. Labels are strings."""
    message = database.by_id[frame.arbitration_id]
    if len(frame.data) != message.length:
        return {}
    signals = database.decode(message.frame_id, bytes(frame.data))
    return {name: v if isinstance(v, int | float) else str(v) for name, v in signals.items()}


def text_writer() -> Callable[..., None]:
    def write(database: Any, frame: Any, verdict: str) -> None:
        name = database.by_id[frame.arbitration_id].name
        signals = signals_of(database, frame)
        body = " ".join(f"{key}={value}" for key, value in signals.items() if key != "crc")
        mark = "" if verdict == "ok" else f"  [{verdict}]"
        print(f"{frame.timestamp:.6f}  {name:<15} {body}{mark}".rstrip())

    return write


def csv_writer() -> Callable[..., None]:
    rows = csv.writer(sys.stdout, lineterminator="\n")
    rows.writerow(COLUMNS)

    def write(database: Any, frame: Any, verdict: str) -> None:
        name = database.by_id[frame.arbitration_id].name
        time_s = f"{frame.timestamp:.6f}"
        signals = signals_of(database, frame) or {"": ""}
        for signal, value in signals.items():
            unit = database.unit(frame.arbitration_id, signal) if signal else ""
            rows.writerow((time_s, name, signal, value, unit, verdict))

    return write


def jsonl_writer() -> Callable[..., None]:
    def write(database: Any, frame: Any, verdict: str) -> None:
        row = {
            "time_s": round(frame.timestamp, 6),
            "id": frame.arbitration_id,
            "message": database.by_id[frame.arbitration_id].name,
            "verdict": verdict,
            "signals": signals_of(database, frame),
        }
        print(json.dumps(row))

    return write


WRITERS: dict[str, Callable[[], Callable[..., None]]] = {
    "text": text_writer,
    "csv": csv_writer,
    "jsonl": jsonl_writer,
}
