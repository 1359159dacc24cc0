"""`quiesce can stop`: emergency stop over the bus."""

import argparse
import sys
from typing import Any

from quiesce.base.command import finite_number
from quiesce.base.errors import EXIT_FAILED, UsageError
from quiesce.cli.can.bus_options import add_bus_options, bus_of
from quiesce.cli.can.options import check_seconds

EPILOG = """examples:
  quiesce can stop --bus socketcan:can0
  quiesce can stop --yes --bus slcan:/dev/ttyACM0

Repeats EmergencyStop until the controller reports fault ESTOP: safe current, latched until it is
acknowledged. Exit code 1 where that was not confirmed in time. A bus is no replacement for the
emergency stop's own wire.
"""


def add_parser(commands: argparse._SubParsersAction) -> None:
    parser = commands.add_parser(
        "stop",
        help="emergency stop",
        description="Emergency stop over the bus, confirmed by the controller.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--yes", action="store_true", help="do not ask")
    parser.add_argument(
        "--timeout-s",
        type=finite_number,
        default=5.0,
        metavar="T",
        help="for its report (%(default)g)",
    )
    add_bus_options(parser)
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    from quiesce.can.database import load
    from quiesce.can.emergency import press
    from quiesce.can.link import Link
    from quiesce.can.stopping import until_stopped

    check_seconds("--timeout-s", args.timeout_s)
    bus = without_pause(bus_of(args))
    if not args.yes and not is_confirmed(bus.name):
        print("quiesce: not stopped", file=sys.stderr)
        return EXIT_FAILED
    with until_stopped() as stop, Link(bus) as link:
        state = press(link, load(), args.timeout_s, stop)
    if state is None:
        print(
            f"quiesce: {bus.name}: NOT CONFIRMED: no Status with fault ESTOP; use the emergency "
            "stop's own switch",
            file=sys.stderr,
        )
        return EXIT_FAILED
    print(f"stopped: the controller reports state {state}, fault ESTOP")
    return 0


def without_pause(bus: Any) -> Any:
    """Serial lines pause after opening for boards that reset then (quiesce.can.slcan). An emergency
    stop must not wait for that: a board that did not reset gets the first frame at once, one that
    did gets a later one."""
    return bus.with_default("sleep_after_open", 0.0) if bus.interface == "slcan" else bus


def is_confirmed(name: str) -> bool:
    """UsageError where there is nobody to ask."""
    if not sys.stdin.isatty():
        raise UsageError("stop asks for confirmation on a terminal; without one add --yes")
    print(
        f"Emergency stop of the controller on {name}? [y/N] ", end="", file=sys.stderr, flush=True
    )
    return sys.stdin.readline().strip().lower() in ("y", "yes")
