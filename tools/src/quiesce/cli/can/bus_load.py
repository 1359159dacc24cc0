"""`quiesce can bus-load`: bus load and worst-case response times, computed from the DBC."""

import argparse
import json
from operator import itemgetter
from typing import Any

from quiesce.base.command import finite_number
from quiesce.base.errors import UsageError
from quiesce.base.table import format_table
from quiesce.cli.can.options import add_database_option, database_of
from quiesce.cli.terminal import show

EPILOG = """examples:
  quiesce can bus-load
  quiesce can bus-load --bitrate 250000 --sensor-node
  quiesce can bus-load --sensors 1 --dampers 2
  quiesce can bus-load --errors-per-s 10 --jitter-ms 0.1 --json

Longest frames (worst-case bit stuffing), each message at its least period: its cycle time, or for
services the least time between two. 'response' is from the event to the frame's last bit, when
everything is queued in the worst phase (Davis et al. 2007). '> period': a message may wait for
longer than its own period and needs a queue in its sender.
"""


MOST_SENSORS, MOST_DAMPERS = 8, 4  # that the interface has messages for


def add_parser(commands: argparse._SubParsersAction) -> None:
    parser = commands.add_parser(
        "bus-load",
        help="bus load and worst-case response times",
        description="Bus load and worst-case response times, computed from the DBC.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--bitrate", type=int, default=500_000, metavar="BIT/S", help="(500000)")
    parser.add_argument(
        "--sensor-node", action="store_true", help="response times with AccelSample on the bus"
    )
    parser.add_argument(
        "--sensors",
        type=int,
        metavar="N",
        help="sensors on the bus, 0 .. 8, in totals and response times (1 in totals)",
    )
    parser.add_argument(
        "--dampers", type=int, default=1, metavar="N", help="dampers on it, 1 .. 4 (%(default)d)"
    )
    parser.add_argument(
        "--no-raw", action="store_true", help="response times without raw streaming"
    )
    parser.add_argument(
        "--jitter-ms",
        type=finite_number,
        default=0.0,
        metavar="T",
        help="of the queueing (%(default)g)",
    )
    parser.add_argument(
        "--errors-per-s",
        type=finite_number,
        default=0.0,
        metavar="N",
        help="bus errors (%(default)g)",
    )
    parser.add_argument("--json", action="store_true", help="print one JSON object")
    add_database_option(parser)
    parser.set_defaults(run=run)


def check(args: argparse.Namespace) -> None:
    if not 10_000 <= args.bitrate <= 1_000_000:
        raise UsageError(f"--bitrate {args.bitrate}: classic CAN has 10000 .. 1000000 bit/s")
    for option, number, low, high in (
        ("--sensors", args.sensors, 0, MOST_SENSORS),
        ("--dampers", args.dampers, 1, MOST_DAMPERS),
    ):
        if number is not None and not low <= number <= high:
            raise UsageError(f"{option} {number}: {low} .. {high}")
    for option, value in (
        ("--jitter-ms", args.jitter_ms),
        ("--errors-per-s", args.errors_per_s),
    ):
        if not 0.0 <= value <= 1e6:
            raise UsageError(f"{option} {value:g}: 0 .. 1000000")


def run(args: argparse.Namespace) -> int:
    check(args)
    report = computed(args)
    show(json.dumps(report, indent=1) if args.json else text(report))
    return 0


def computed(args: argparse.Namespace) -> dict[str, Any]:
    from quiesce.can import bus_load

    database = database_of(args)
    raw = bus_load.named(database, bus_load.RAW)
    left_out = raw if args.no_raw else []
    sensors = args.sensors if args.sensors is not None else int(args.sensor_node)
    chosen = [
        one for one in bus_load.on_bus(database, sensors, args.dampers) if one not in left_out
    ]
    if not chosen:
        raise UsageError(f"{database.file}: no message has a cycle time (GenMsgCycleTime)")
    analysis = bus_load.Analysis(chosen, args.bitrate, args.jitter_ms, args.errors_per_s)
    sent = bus_load.slcan_messages(database, args.dampers)
    need, baud = bus_load.baud_needed(sent)
    need_less, baud_less = bus_load.baud_needed([one for one in sent if one not in raw])
    in_totals = 1 if args.sensors is None else args.sensors
    return {
        "bitrate": args.bitrate,
        "load_pct": bus_load.totals_pct(database, args.bitrate, in_totals, args.dampers),
        "messages": [row(analysis, index) for index in range(len(analysis.streams))],
        "slcan": {
            "bits_per_s": need,
            "baud": baud,
            "bits_per_s_without_raw": need_less,
            "baud_without_raw": baud_less,
        },
    }


def row(analysis: Any, index: int) -> dict[str, Any]:
    stream = analysis.streams[index]
    bits = analysis.response(index)
    period_ms = stream.message.period_ms
    response_ms = None if bits is None else 1000.0 * bits / analysis.bitrate
    return {
        "name": stream.message.name,
        "id": stream.message.frame_id,
        "bytes": stream.message.length,
        "bits": stream.bits,
        "period_ms": period_ms,
        "load_pct": 100.0 * stream.bits / (period_ms * analysis.bitrate / 1000),
        "response_ms": response_ms,
        "is_within_period": response_ms is not None and response_ms <= period_ms,
    }


def text(report: dict[str, Any]) -> str:
    from quiesce.can.bus_load import totals_table

    plain = itemgetter("bytes", "bits", "period_ms", "load_pct")
    rows = [
        [
            one["name"], f"0x{one['id']:03X}", *plain(one),
            "no bound" if one["response_ms"] is None else one["response_ms"],
            "" if one["is_within_period"] else "> period",
        ]
        for one in report["messages"]
    ]  # fmt: skip
    head = ["message", "id", "bytes", "bits", "period ms", "load %||.2f", "response ms||.3f", ""]
    slcan = report["slcan"]
    return "\n".join(
        [
            format_table(head, rows, left=(0, 1, 7)),
            "",
            totals_table(report["load_pct"], report["bitrate"]),
            "",
            f"SLCAN: a controller on a UART sends {slcan['bits_per_s_without_raw']:.0f} bit/s: "
            f"{rate_text(slcan['baud_without_raw'])}; with raw streaming "
            f"{slcan['bits_per_s']:.0f}: {rate_text(slcan['baud'])}",
        ]
    )


def rate_text(baud: int | None) -> str:
    return "beyond usual rates" if baud is None else f"{baud} baud"
