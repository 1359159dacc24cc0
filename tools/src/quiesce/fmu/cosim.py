"""Somebody else's plant, an FMU, under the controller, another one: in lock-step, as the bench is.

In each step the plant gets the currents of the controller's last tick and the controller the
plant's values of now; then both go on by a tick.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from quiesce.base.errors import UsageError
from quiesce.fmu.slave import Slave

PLANT, CONTROLLER = "plant ", "controller "  # before names of columns


@dataclass(frozen=True)
class Wire:
    """From an output of one to an input of the other; what is there times factor plus offset."""

    source: str
    target: str
    factor: float = 1.0
    offset: float = 0.0


@dataclass(frozen=True)
class Run:
    time_s: np.ndarray
    columns: dict[str, np.ndarray]  # by whose they are and their names


def parse_wire(text: str) -> tuple[str, Wire]:
    """TARGET=SOURCE, TARGET=SOURCE*FACTOR or TARGET=SOURCE*FACTOR+OFFSET: the target's name, too.

    UsageError for anything else.
    """
    target, equals, source = text.partition("=")
    name, _, numbers = source.partition("*")
    factor, _, offset = numbers.partition("+") if numbers else ("1", "", "")
    try:
        if not (equals and target.strip() and name.strip()):
            raise ValueError
        wire = Wire(name.strip(), target.strip(), float(factor), float(offset or 0))
        if not np.isfinite([wire.factor, wire.offset]).all():
            raise ValueError
    except ValueError:
        raise UsageError(
            f"--wire {text}: expected INPUT=OUTPUT, with *FACTOR and +OFFSET where units differ"
        ) from None
    return wire.target, wire


def wired(
    given: Sequence[Wire], sources: Slave, targets: Slave, optional: Callable[[str], bool]
) -> list[Wire]:
    """The given wires into one, and one of the same name for each input that has none.

    optional: inputs that may stay at their start values. UsageError where another one is left, or
    a wire names what is not there.
    """
    inputs = targets.names("input")
    outputs = sources.names("output")
    for wire in given:
        targets.variable(wire.target)
        sources.variable(wire.source)
        if wire.target not in inputs:
            raise UsageError(f"--wire {wire.target}=..: it is no input of {targets.name}")
    by_hand = {wire.target for wire in given}
    same = [Wire(name, name) for name in inputs if name in outputs and name not in by_hand]
    missing = [
        name
        for name in inputs
        if name not in by_hand and name not in outputs and not optional(name)
    ]
    if missing:
        raise UsageError(
            f"nothing goes into {', '.join(missing)} of {targets.name}: --wire INPUT=OUTPUT; "
            f"{sources.name} has the outputs {', '.join(outputs)}"
        )
    return [*given, *same]


def split(
    wires: Mapping[str, Wire], plant: Slave, controller: Slave
) -> tuple[list[Wire], list[Wire]]:
    """Those into the plant, and those into the controller. UsageError where neither has it."""
    into_plant, into_controller = [], []
    for target, wire in wires.items():
        if target in controller.names("input"):
            into_controller.append(wire)
        else:
            plant.variable(target)
            into_plant.append(wire)
    return into_plant, into_controller


class Transfer:
    """Carries values over wires."""

    def __init__(self, wires: Sequence[Wire], sources: Slave, targets: Slave) -> None:
        self._read = sources.reader([wire.source for wire in wires])
        self._write = targets.writer([wire.target for wire in wires])
        self._wires = wires

    def __call__(self) -> None:
        values = self._read()
        self._write(
            wire.factor * value + wire.offset
            for wire, value in zip(self._wires, values, strict=True)
        )


def run(
    plant: Slave,
    controller: Slave,
    wires: Mapping[str, Wire],
    tick_s: float,
    ticks: int,
    columns: Sequence[str],
    is_off: bool = False,
    progress: Callable[[int], None] = lambda _: None,
) -> Run:
    """Runs both. columns: outputs of either that are kept; of both where both have that name.
    is_off: nothing of the controller's reaches the plant."""
    into_plant, into_controller = split(wires, plant, controller)
    to_controller = Transfer(
        wired(into_controller, plant, controller, is_optional), plant, controller
    )
    to_plant = Transfer(wired(into_plant, controller, plant, lambda _: True), controller, plant)
    kept = [
        (who, [name for name in columns if name in slave.names("output")], slave)
        for who, slave in ((PLANT, plant), (CONTROLLER, controller))
    ]
    readers = [slave.reader(names) for _, names, slave in kept]
    rows = np.empty((ticks, sum(len(names) for _, names, _ in kept)))
    for tick in range(ticks):
        to_controller()
        if not is_off:
            to_plant()
        now_s = tick * tick_s
        rows[tick] = [value for read in readers for value in read()]
        controller.step(now_s, tick_s)
        plant.step(now_s, tick_s)
        progress(tick)
    names = [f"{who}{name}" for who, own, _ in kept for name in own]
    return Run(np.arange(ticks) * tick_s, dict(zip(names, rows.T, strict=True)))


def is_optional(name: str) -> bool:
    """Inputs of the controller with a start value that serves: the operator's, whether a sample is
    fresh, measured currents."""
    return name in ("enable", "estop", "fault_reset") or name.endswith(
        (".is_fresh", ".current_A", ".current_is_measured")
    )


def usual_columns(plant: Slave, controller: Slave) -> list[str]:
    """What people look at: numbers of the plant; currents, frequency, RMS and state."""
    numbers = [
        name
        for name in plant.names("output")
        if plant.variable(name).type in ("Real", "Float64", "Float32")
    ]
    told = [
        name
        for name in controller.names("output")
        if name.endswith(".current_cmd_A") or name in ("freq_Hz", "rms_m_s2", "state")
    ]
    return [*numbers, *(name for name in told if name not in numbers)]


def write_csv(file: Path, run: Run) -> None:
    table = np.column_stack([run.time_s, *run.columns.values()])
    head = ",".join(["t_s", *(name.replace(" ", ".") for name in run.columns)])
    np.savetxt(file, table, fmt="%.9g", delimiter=",", header=head, comments="")
