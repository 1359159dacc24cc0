"""`quiesce can replay FILE`: a log back onto a bus, with its timing."""

import argparse
import math
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from quiesce.base.command import finite_number
from quiesce.base.errors import EXIT_FAILED, UsageError
from quiesce.can.database import FIRST_LOCKSTEP_ID
from quiesce.cli.can.bus_options import add_bus_options, bus_of
from quiesce.cli.can.options import add_database_option, add_only_option, database_of, ids_of

EPILOG = """examples:
  quiesce can replay run.blf --bus udp_multicast:239.74.163.2
  quiesce can replay run.asc --only Status,Motion --speed 10 --bus socketcan:can0

Never sends what a controller or a driver would act on, unless --include-commands: CurrentDemand of
every damper, EmergencyStop, OperatorCommand, ServiceRequest and TableData (which may change
parameters and tables), what sensor nodes and drivers send (AccelSample, SensorSample1 ..,
CurrentMeasured), lock-step messages (0x600 .. 0x6FF). Their ids are those of the shipped DBC; --dbc
only names messages for --only.
"""

COMMANDS = ("CurrentDemand", "EmergencyStop", "OperatorCommand", "ServiceRequest", "TableData")
# The controller would take what they sent for what is.
MEASURING = ("Sensor", "Driver")
LOCKSTEP_IDS = range(FIRST_LOCKSTEP_ID, 0x700)
TELL_S = 5.0
# Frames that are due at once wait no longer than a timer can tell.
LEAST_WAIT_S = 0.0005


def add_parser(commands: argparse._SubParsersAction) -> None:
    parser = commands.add_parser(
        "replay",
        help="a log back onto a bus",
        description="Send a log with its timing.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("file", type=Path, metavar="FILE")
    parser.add_argument(
        "--speed", type=finite_number, default=1.0, metavar="X", help="times as fast (%(default)g)"
    )
    add_only_option(parser)
    parser.add_argument(
        "--include-commands", action="store_true", help="send what is acted on, too: see below"
    )
    add_bus_options(parser)
    add_database_option(parser)
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    from quiesce.can.link import Link
    from quiesce.can.readers import read_log
    from quiesce.can.stopping import until_stopped

    if not (math.isfinite(args.speed) and args.speed > 0.0):
        raise UsageError(f"--speed {args.speed:g}: above 0, please")
    bus, database = bus_of(args), database_of(args)
    only = ids_of(args.only, database)
    withheld = set() if args.include_commands else withheld_ids()
    for _ in read_log(args.file):  # the whole of it, before anything is sent
        pass
    counts = {"sent": 0, "refused": 0, "withheld": 0}
    with until_stopped() as stop, Link(bus) as link:
        for frame in on_time(read_log(args.file), args.speed, stop):
            if only is not None and frame.arbitration_id not in only:
                continue
            if frame.arbitration_id in withheld and not frame.is_extended_id:
                counts["withheld"] += 1
                continue
            is_sent = not frame.is_error_frame and link.send_message(as_sent(frame))
            counts["sent" if is_sent else "refused"] += 1
    text = f"{counts['sent']} frames sent"
    if counts["withheld"]:
        text += (
            f", {counts['withheld']} withheld: commands, measurements or lock-step "
            "(--include-commands sends them)"
        )
    if counts["refused"]:
        text += f", {counts['refused']} not taken by the bus"
    print(text, file=sys.stderr)
    return EXIT_FAILED if counts["refused"] else 0


def withheld_ids() -> set[int]:
    """What a controller or a driver acts on. Of the shipped DBC in any case: the controller on
    the bus knows no other."""
    from quiesce.can.database import load

    database = load()
    commands = {one.frame_id for one in database.messages if one.kind in COMMANDS}
    measured = {one.frame_id for one in database.messages if one.sender in MEASURING}
    return commands | measured | set(LOCKSTEP_IDS)


def as_sent(frame: Any) -> Any:
    frame.channel = None
    frame.is_rx = False
    return frame


def on_time(frames: Iterator[Any], speed: float, stop: Any) -> Iterator[Any]:
    """Each when it is due, until `stop` is set. Times that go back count as no time."""
    start_s = time.monotonic()
    first_s: float | None = None
    told_s = start_s
    for count, frame in enumerate(frames):
        first_s = frame.timestamp if first_s is None else first_s
        due_s = start_s + (frame.timestamp - first_s) / speed
        wait_s = due_s - time.monotonic()
        if (wait_s > LEAST_WAIT_S and stop.wait(wait_s)) or stop.is_set():
            return
        if time.monotonic() - told_s > TELL_S:
            told_s = time.monotonic()
            print(f"{count} frames, {frame.timestamp - first_s:.1f} s of the log", file=sys.stderr)
        yield frame
