"""CAN buses by name: `INTERFACE:CHANNEL`, over whatever python-can has a driver for."""

import argparse
import os
from dataclasses import dataclass, replace
from typing import Any

from quiesce.base.errors import UsageError, one_line

EXAMPLES = (
    "socketcan:can0, slcan:/dev/ttyACM0@115200, slcan:socket://127.0.0.1:5556, "
    "udp_multicast:239.74.163.2, pcan:PCAN_USBBUS1"
)
VARIABLE = "QUIESCE_CAN_BUS"


@dataclass(frozen=True)
class Bus:
    """Which bus to open, and with what."""

    interface: str
    channel: str
    bitrate: int | None
    options: tuple[tuple[str, Any], ...]

    @property
    def name(self) -> str:
        return f"{self.interface}:{self.channel}"

    def with_default(self, key: str, value: Any) -> "Bus":
        """The same with an option that the user did not give."""
        if key in dict(self.options):
            return self
        return replace(self, options=(*self.options, (key, value)))

    def driver_options(self) -> dict[str, Any]:
        """What the driver gets beside the channel."""
        options = dict(self.options)
        if self.bitrate is not None:
            options["bitrate"] = self.bitrate
        if self.interface == "socketcan":
            # Without it the kernel hands this socket no FD frames. Classic interfaces take it, too;
            # a kernel without CAN FD refuses it, and python-can goes on with classic frames.
            options.setdefault("fd", True)
        return options

    def open(self) -> Any:
        """A python-can bus. Exception of any class, as the driver has it, where it fails."""
        from quiesce.can.python_can import can

        options = self.driver_options()
        if self.interface == "slcan" and os.name == "posix":
            from quiesce.can.slcan import SlcanBus

            return SlcanBus(self.channel, **options)
        return can.Bus(interface=self.interface, channel=self.channel, **options)


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


def reason_of(error: BaseException) -> str:
    """Why a driver failed, in its own words and those of what it wraps."""
    words = [one_line(error) or type(error).__name__]
    cause = error.__cause__ or error.__context__
    if cause is not None and one_line(cause) and one_line(cause) not in words[0]:
        words.append(one_line(cause))
    return ": ".join(words)[:300]
