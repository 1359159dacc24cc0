"""`quiesce can check`: latency, losses and cycle times of a bus at work."""

import argparse
import json
import time
from dataclasses import dataclass, field
from operator import itemgetter
from typing import Any

from quiesce.base.command import finite_number
from quiesce.base.errors import EXIT_FAILED, UsageError
from quiesce.base.table import format_table
from quiesce.can.database import CYCLIC
from quiesce.cli.can.bus_options import add_bus_options, bus_of
from quiesce.cli.can.options import check_seconds
from quiesce.cli.terminal import show

EPILOG = """examples:
  quiesce can check --bus socketcan:can0
  quiesce can check --seconds 60 --json --bus slcan:/dev/ttyACM0

Asks the controller for a parameter again and again (round trip of ServiceRequest and ServiceReply)
while everything that arrives is counted: gaps of the alive counters, wrong CRCs, and mean cycle
times against the DBC. Exit code 1 where a frame was lost, a CRC was wrong, a request was not
answered, a cyclic message of the controller is missing, or a cycle time is off.
"""

CONTROLLER = "Controller"
SETTLE_S = 0.2


@dataclass
class Trips:
    """Round trips of requests."""

    times_ms: list[float] = field(default_factory=list)
    unanswered: int = 0

    def report(self) -> dict[str, Any]:
        times = sorted(self.times_ms)
        if not times:
            return {"answered": 0, "unanswered": self.unanswered}
        return {
            "answered": len(times),
            "unanswered": self.unanswered,
            "median_ms": times[len(times) // 2],
            "p99_ms": times[min(len(times) - 1, len(times) * 99 // 100)],
            "worst_ms": times[-1],
        }


def add_parser(commands: argparse._SubParsersAction) -> None:
    parser = commands.add_parser(
        "check",
        help="latency, losses and cycle times",
        description="Measure latency, losses and cycle times of a bus with a controller.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument(
        "--seconds", type=finite_number, default=5.0, metavar="T", help="(%(default)g)"
    )
    parser.add_argument(
        "--tolerance", type=finite_number, default=10.0, metavar="PCT",
        help="of the mean cycle times, besides one frame more or less (%(default)g)",
    )  # fmt: skip
    parser.add_argument("--json", action="store_true", help="print one JSON object")
    add_bus_options(parser)
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    from quiesce.can.database import load
    from quiesce.can.link import Link
    from quiesce.can.services import Services, misunderstood
    from quiesce.can.traffic import Traffic

    check_seconds("--seconds", args.seconds)
    if not 0.0 < args.tolerance <= 100.0:
        raise UsageError(f"--tolerance {args.tolerance:g}: percent, above 0, at most 100")
    database = load()
    traffic = Traffic(database)
    gaps: list[str] = []

    def take(event: Any) -> None:
        if hasattr(event, "arbitration_id"):
            traffic.take(event)
        elif hasattr(event, "reason"):
            gaps.append(f"the bus was lost: {event.reason}")

    with Link(bus_of(args)) as link:
        services = Services(link, database)
        services.wait(SETTLE_S)  # a driver may hold frames from before
        services.on_event = take
        start_s = time.monotonic()
        trips = measure(services, args.seconds)
        duration_s = time.monotonic() - start_s
    rows = [row(traffic, one, duration_s, args.tolerance) for one in expected(traffic)]
    problems = gaps + problems_of(traffic, trips, rows)
    if services.identification and (why := misunderstood(database, services.identification)):
        problems.append(why)
    report = {
        "seconds": duration_s,
        "round_trip": trips.report(),
        "messages": rows,
        **traffic.summary(),
        "problems": problems,
    }
    show(json.dumps(report, indent=1) if args.json else text(report))
    return EXIT_FAILED if problems else 0


def measure(services: Any, seconds: float) -> Trips:
    trips = Trips()
    end_s = time.monotonic() + seconds
    while time.monotonic() < end_s:
        services.wait(max(0.0, services.next_s - time.monotonic()))
        start_s = time.monotonic()
        if services.ask_once("READ") is None:
            trips.unanswered += 1
        else:
            trips.times_ms.append(1000.0 * (time.monotonic() - start_s))
    return trips


def expected(traffic: Any) -> list[Any]:
    """Cyclic messages: all of the controller's, others where they were seen."""
    return [
        one
        for one in traffic.database.messages
        if one.send_type == CYCLIC
        and (one.sender == CONTROLLER or traffic.seen.get(one.frame_id) is not None)
    ]


def row(traffic: Any, message: Any, duration_s: float, tolerance_pct: float) -> dict[str, Any]:
    seen = traffic.seen.get(message.frame_id)
    count = seen.count if seen else 0
    wanted = 1000.0 * duration_s / message.cycle_ms
    return {
        "name": message.name,
        "count": count,
        "cycle_ms": message.cycle_ms,
        "mean_ms": seen.period_ms if seen else None,
        "longest_ms": 1000.0 * seen.longest_s if seen and count > 1 else None,
        "lost": seen.lost if seen else None,
        "wrong_crc": seen.wrong_crc if seen else 0,
        "is_on_time": abs(count - wanted) <= 1.0 + wanted * tolerance_pct / 100.0,
    }


def problems_of(traffic: Any, trips: Trips, rows: list[dict[str, Any]]) -> list[str]:
    problems = []
    if not trips.times_ms:
        problems.append("no controller answers")
    elif trips.unanswered:
        problems.append(f"{trips.unanswered} requests were not answered")
    for name, words in (
        ("lost", "frames were lost"),
        ("wrong_crc", "frames have a wrong CRC"),
        ("wrong_length", "frames have a wrong length"),
        ("repeated", "frames repeat their alive counter"),
    ):
        if count := traffic.total(name):
            problems.append(f"{count} {words}")
    for one in rows:
        if not one["is_on_time"]:
            mean = "none arrived" if one["mean_ms"] is None else f"{one['mean_ms']:.2f} ms"
            problems.append(f"{one['name']}: {mean}, its cycle time is {one['cycle_ms']} ms")
    return problems


def text(report: dict[str, Any]) -> str:
    plain = itemgetter("name", "count", "cycle_ms", "mean_ms", "longest_ms", "lost", "wrong_crc")
    rows = [(*plain(one), "" if one["is_on_time"] else "OFF") for one in report["messages"]]
    head = ["message", "count", "cycle ms", "mean ms||.2f", "longest ms||.2f", "lost", "crc", ""]
    trip = report["round_trip"]
    lines = [format_table(head, rows, left=(0, 7)), ""]
    if trip["answered"]:
        lines.append(
            f"round trip  median {trip['median_ms']:.2f} ms, 99 % {trip['p99_ms']:.2f} ms, worst "
            f"{trip['worst_ms']:.2f} ms ({trip['answered']} requests)"
        )
    lines += [f"problem     {one}" for one in report["problems"]]
    return "\n".join([*lines, f"result      {'FAILED' if report['problems'] else 'ok'}"])
