"""`quiesce can list`: buses that python-can finds here, and why there are no others."""

import argparse
import importlib
import json
import socket
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict, dataclass
from typing import Any

from quiesce.base.table import format_table
from quiesce.can.buses import Bus, reason_of
from quiesce.cli.terminal import show

EPILOG = """examples:
  quiesce can list
  quiesce can list --json

'works': it was opened, which is done only where that disturbs nobody; 'seen': it is there. Drivers
of adapters need their makers' libraries, see python-can's documentation. Serial lines are listed
under slcan; whether an SLCAN adapter is behind one shows when it is opened.
"""

# Opening one of these sends nothing and acknowledges nothing.
WORKS, SEEN, ABSENT = "works", "seen", "-"
HARMLESS = ("socketcan", "udp_multicast", "virtual")


@dataclass(frozen=True)
class Found:
    interface: str
    channel: str  # empty: none was found
    state: str  # WORKS, SEEN or ABSENT
    note: str


def add_parser(commands: argparse._SubParsersAction) -> None:
    parser = commands.add_parser(
        "list",
        help="buses that there are here",
        description="Interfaces and channels that python-can finds on this machine.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--json", action="store_true", help="print JSON")
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    from quiesce.can.python_can import can

    names = sorted(can.VALID_INTERFACES)
    with ThreadPoolExecutor(8) as pool:  # some drivers listen for seconds
        found = [one for rows in pool.map(look, names) for one in rows]
    found.sort(key=lambda one: (one.state == ABSENT, one.state == SEEN, one.interface, one.channel))
    if args.json:
        print(json.dumps([asdict(one) for one in found], indent=1))
        return 0
    rows = [[f"{one.interface}:{one.channel}", one.state, one.note] for one in found]
    show(format_table(["--bus", "", "note"], rows, left=(0, 1, 2)))
    return 0


def look(interface: str) -> list[Found]:
    """What there is of one interface; at least one row."""
    from can.interfaces import BACKENDS

    if interface == "slcan":
        return serial_lines()
    module, name = BACKENDS[interface]
    try:
        driver = getattr(importlib.import_module(module), name)
        configs = list(driver._detect_available_configs())
    except NotImplementedError:
        return [Found(interface, "", ABSENT, "cannot be searched for: name its channel")]
    except Exception as error:  # each driver has its own classes
        return [Found(interface, "", ABSENT, f"its driver does not load: {reason_of(error)}")]
    if not configs:
        return [Found(interface, "", ABSENT, absent(interface))]
    return [tried(interface, str(config.get("channel", ""))) for config in configs]


def absent(interface: str) -> str:
    if interface == "socketcan":
        try:
            socket.socket(socket.AF_CAN, socket.SOCK_RAW, socket.CAN_RAW).close()
        except (OSError, AttributeError) as error:
            return f"this kernel has no CAN: {error}"
        return "no interface is up: 'ip link set can0 up type can bitrate 500000'"
    return "none connected, or its maker's library is not installed"


def tried(interface: str, channel: str) -> Found:
    if interface not in HARMLESS:
        return Found(interface, channel, SEEN, "its driver sees it")
    try:
        bus: Any = Bus(interface, channel, None, ()).open()
    except Exception as error:
        return Found(interface, channel, ABSENT, reason_of(error))
    bus.shutdown()
    note = "this process only, for tests" if interface == "virtual" else "opened"
    return Found(interface, channel, WORKS, note)


def serial_lines() -> list[Found]:
    from serial.tools import list_ports

    found = []
    for port in list_ports.comports():
        note = port.description if port.description != "n/a" else "serial line"
        found.append(Found("slcan", port.device, SEEN, note))
    return found or [
        Found("slcan", "", ABSENT, "no serial line; pseudo-terminals and socket://HOST:PORT work")
    ]
