"""Variables of a rig by path, and where each of them is.

MESSAGE/SIGNAL     what the controller, its sensors and its driver send: status/freq_uHz
parameters/NAME    parameters of the controller
rig/...            what is around it, where it is in the computer: rig/control, rig/drive_V
"""

import re
from dataclasses import dataclass

from quiesce.base.errors import UsageError
from quiesce.base.nearest import meant
from quiesce.can.database import CYCLIC, Database
from quiesce.engine.params import parameters

PARAMETERS = "parameters"
RIG = "rig"
SENDERS = ("Controller", "Driver", "Sensor")
STREAMED = "RawSample"  # each tick, while Rig.stream_raw has asked for it
PROTECTION = ("alive", "crc")
# Of a state of the rig (docs/reference/rig-protocol.md): path, unit, whether it is an order, too.
OF_RIG = (
    ("control", "-", True),
    ("drive_V", "V", True),
    ("freq_Hz", "Hz", False),
    ("time_s", "s", False),
    ("ticks", "-", False),
    *(
        (f"vibration/{window}/{name}", unit, False)
        for window in ("now", "on", "off")
        for name, unit in (("displacement_um", "um"), ("accel_m_s2", "m/s2"))
    ),
    ("pace/overruns", "-", False),
    ("pace/latest_us", "us", False),
)


@dataclass(frozen=True)
class Variable:
    path: str
    unit: str  # "-": none
    is_writable: bool
    # What it is of: a signal of a message, a parameter, or keys of the rig's state.
    frame_id: int = -1
    signal: str = ""
    index: int = -1
    keys: tuple[str, ...] = ()


def catalogue(database: Database, is_simulated: bool) -> dict[str, Variable]:
    """By path, in the order in which people look for them."""
    found = [*signals_of(database), *parameters_of()]
    if is_simulated:
        found += [
            Variable(f"{RIG}/{path}", unit, is_writable, keys=tuple(path.split("/")))
            for path, unit, is_writable in OF_RIG
        ]
    return {one.path: one for one in found}


def signals_of(database: Database) -> list[Variable]:
    """Of messages that come by themselves, and of the stream of samples."""
    return [
        Variable(
            f"{snake(message.name)}/{signal.name}",
            signal.unit or "-",
            False,
            frame_id=message.frame_id,
            signal=signal.name,
        )
        for message in database.messages
        if (message.send_type == CYCLIC or message.name == STREAMED)
        and message.sender in SENDERS
        and not message.is_lockstep
        for signal in database.signals(message.frame_id)
        if signal.name not in PROTECTION
    ]


def parameters_of() -> list[Variable]:
    return [
        Variable(f"{PARAMETERS}/{one['name']}", one["unit"], True, index=one["index"])
        for one in parameters()
    ]


def snake(name: str) -> str:
    """CurrentDemand1 as current_demand1."""
    return re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "_", name).lower()


def named(known: dict[str, Variable], path: str) -> Variable:
    """UsageError where there is none of that path."""
    if path not in known:
        raise UsageError(f"no variable {path!r}{meant(path, known)}; Rig.variables() has all")
    return known[path]
