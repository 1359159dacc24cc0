"""CAN buses by name: `INTERFACE:CHANNEL`, over whatever python-can has a driver for."""

import os
from dataclasses import dataclass, replace
from typing import Any

from quiesce.base.errors import one_line


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


def reason_of(error: BaseException) -> str:
    """Why a driver failed, in its own words and those of what it wraps."""
    words = [one_line(error) or type(error).__name__]
    cause = error.__cause__ or error.__context__
    if cause is not None and one_line(cause) and one_line(cause) not in words[0]:
        words.append(one_line(cause))
    return ": ".join(words)[:300]
