"""Rigs by name: a target of a rig in the computer, a bus, or a file that says which."""

import tomllib
from dataclasses import replace
from pathlib import Path
from typing import Any

from quiesce.base.errors import UsageError, one_line
from quiesce.can.buses import Bus
from quiesce.can.link import Link
from quiesce.rig.access import Rig
from quiesce.rig.free import FreeSimulation
from quiesce.rig.options import HOST, LAW, TARGETS, RigSetup
from quiesce.rig.programs import Elsewhere, Quiesced
from quiesce.rig.simulation import Simulation, own_bus

OF_SIMULATION = {"plant": str, "board": str, "law": str, "set": list, "can": str}
KEYS = {"rig": str, "bus_options": dict, **OF_SIMULATION}


def open_rig(where: str | Path = HOST, setup: RigSetup | None = None) -> Rig:
    """where: a rig in the computer by the target of its controller, "host", "mps2" or "linux";
    "INTERFACE:CHANNEL", a controller on that bus; or a TOML file with the keys of KEYS, `rig` being
    one of the former. setup: of a rig in the computer. Enter what it returns. UsageError where it
    is none of them.
    """
    text = str(where)
    if text.endswith(".toml"):
        return of_file(Path(where))
    if text in TARGETS:
        return in_the_computer(replace(setup or RigSetup(), target=text))
    if setup is not None:
        raise UsageError(f"rig {text}: plant, board, law and settings are of a rig in the computer")
    return Rig(Link(bus_named(text, {})))


def in_the_computer(setup: RigSetup) -> Rig:
    bus = own_bus()
    return Rig(Link(bus), simulation_of(setup, bus))


def simulation_of(setup: RigSetup, bus: Bus) -> Simulation:
    """To be entered. UsageError where a file, or what its target needs, is not there."""
    words = setup.words()
    if not setup.is_free:
        return Simulation(words, bus)
    controller = Quiesced(setup.board) if setup.can is None else Elsewhere(setup.can)
    return FreeSimulation(words, setup.tables, bus, controller)


def of_file(file: Path) -> Rig:
    said = read(file)
    where = said.get("rig", HOST)
    options = said.get("bus_options", {})
    named = [key for key in OF_SIMULATION if key in said]
    if where not in TARGETS:
        if named:
            raise UsageError(f"{file}: {named[0]}: is of rig = {one_of_targets()}")
        return Rig(Link(bus_named(where, options)))
    if options:
        raise UsageError(f"{file}: bus_options: rig = '{where}' makes a bus of its own")
    files = {key: file.parent / said[key] if key in said else None for key in ("plant", "board")}
    return in_the_computer(
        RigSetup(
            **files,
            law=said.get("law", LAW),
            settings=said.get("set", []),
            target=where,
            can=said.get("can"),
        )
    )


def one_of_targets() -> str:
    return ", ".join(f"'{one}'" for one in TARGETS)


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
        raise UsageError(
            f"rig {text!r}: {one_of_targets()}, a bus INTERFACE:CHANNEL, or a file .toml"
        )
    return Bus(interface, channel, None, tuple(options.items()))
