"""Rigs by name: `host`, a bus, or a file that says which."""

import tomllib
from pathlib import Path
from typing import Any

from quiesce.base.errors import UsageError, one_line
from quiesce.can.buses import Bus
from quiesce.can.link import Link
from quiesce.rig.access import Rig
from quiesce.rig.options import LAW, RigSetup
from quiesce.rig.simulation import Simulation, own_bus

HOST = "host"
KEYS = {"rig": str, "plant": str, "board": str, "law": str, "set": list, "bus_options": dict}


def open_rig(where: str | Path = HOST, setup: RigSetup | None = None) -> Rig:
    """where: "host", a rig in the computer; "INTERFACE:CHANNEL", a controller on that bus; or a
    TOML file with the keys of KEYS, `rig` being one of the former. setup: of "host". Enter what it
    returns. UsageError where it is none of them.
    """
    text = str(where)
    if text.endswith(".toml"):
        return of_file(Path(where))
    if text == HOST:
        bus = own_bus()
        return Rig(Link(bus), Simulation((setup or RigSetup()).words(), bus))
    if setup is not None:
        raise UsageError(f"rig {text}: plant, board, law and settings are of '{HOST}'")
    return Rig(Link(bus_named(text, {})))


def of_file(file: Path) -> Rig:
    said = read(file)
    where = said.get("rig", HOST)
    options = said.get("bus_options", {})
    of_host = [key for key in ("plant", "board", "law", "set") if key in said]
    if where != HOST and of_host:
        raise UsageError(f"{file}: {of_host[0]}: is of rig = '{HOST}'")
    if where == HOST and options:
        raise UsageError(f"{file}: bus_options: rig = '{HOST}' makes a bus of its own")
    if where != HOST:
        return Rig(Link(bus_named(where, options)))
    files = {key: file.parent / said[key] if key in said else None for key in ("plant", "board")}
    return open_rig(HOST, RigSetup(**files, law=said.get("law", LAW), settings=said.get("set", [])))


def read(file: Path) -> dict[str, Any]:
    """UsageError where it cannot be read, or has other keys or kinds of values."""
    try:
        said = tomllib.loads(file.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
        raise UsageError(f"{file}: cannot be read as TOML: {one_line(error)}")
    for key, value in said.items():
        if key not in KEYS:
            raise UsageError(f"{file}: {key}: unknown key; expected {', '.join(KEYS)}")
        if not isinstance(value, KEYS[key]):
            raise UsageError(f"{file}: {key}: expected a {KEYS[key].__name__}")
    if not all(isinstance(one, str) for one in said.get("set", [])):
        raise UsageError(f"{file}: set: expected texts, NAME=VALUE")
    return said


def bus_named(text: str, options: dict[str, Any]) -> Bus:
    interface, colon, channel = text.partition(":")
    if not colon or not channel:
        raise UsageError(f"rig {text!r}: '{HOST}', a bus INTERFACE:CHANNEL, or a file .toml")
    return Bus(interface, channel, None, tuple(options.items()))
