"""Options that name a bus: `--bus INTERFACE:CHANNEL`, over whatever python-can has a driver for."""

import argparse
import os
from typing import Any

from quiesce.base.errors import UsageError
from quiesce.can.buses import Bus

EXAMPLES = (
    "socketcan:can0, slcan:/dev/ttyACM0@115200, slcan:socket://127.0.0.1:5556, "
    "udp_multicast:239.74.163.2, pcan:PCAN_USBBUS1"
)
VARIABLE = "QUIESCE_CAN_BUS"


def add_bus_options(parser: argparse.ArgumentParser) -> None:
    group = parser.add_argument_group("bus")
    group.add_argument(
        "--bus", default=os.environ.get(VARIABLE), metavar="INTERFACE:CHANNEL",
        help=f"e.g. {EXAMPLES}; 'quiesce can list' shows what there is (environment variable "
        f"{VARIABLE})",
    )  # fmt: skip
    group.add_argument(
        "--bitrate", type=int, metavar="BIT/S",
        help="for adapters that set it (the driver's own; SocketCAN has its own from 'ip link')",
    )  # fmt: skip
    group.add_argument(
        "--bus-option", action="append", default=[], metavar="KEY=VALUE",
        help="anything else that python-can's driver takes; repeatable",
    )  # fmt: skip


def bus_of(args: argparse.Namespace) -> Bus:
    """UsageError where the options do not name a bus."""
    from quiesce.can.python_can import can

    if not args.bus:
        raise UsageError(f"which bus? --bus INTERFACE:CHANNEL, e.g. {EXAMPLES}")
    interface, colon, channel = args.bus.partition(":")
    if not colon or not channel:
        raise UsageError(f"--bus {args.bus}: write INTERFACE:CHANNEL, e.g. {EXAMPLES}")
    if interface not in can.VALID_INTERFACES:
        known = ", ".join(sorted(can.VALID_INTERFACES))
        raise UsageError(f"--bus {args.bus}: no interface '{interface}'; there are {known}")
    if args.bitrate is not None and args.bitrate <= 0:
        raise UsageError(f"--bitrate {args.bitrate}: bits a second, above 0")
    return Bus(interface, channel, args.bitrate, tuple(map(option_of, args.bus_option)))


def option_of(word: str) -> tuple[str, Any]:
    key, equals, text = word.partition("=")
    if not equals or not key.isidentifier():
        raise UsageError(f"--bus-option {word}: write KEY=VALUE")
    return key, value_of(text)


def value_of(text: str) -> Any:
    if text.lower() in ("true", "false"):
        return text.lower() == "true"
    for kind in (int, float):
        try:
            return kind(text)
        except ValueError:
            continue
    return text
