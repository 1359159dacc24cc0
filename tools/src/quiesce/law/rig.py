"""What a recipe works on: a board, its signals, and the structure where that is needed."""

from dataclasses import dataclass
from pathlib import Path

from quiesce.base.errors import UsageError
from quiesce.engine.bench import Bench
from quiesce.law.signal import BY_NAME, Input, signal
from quiesce.law.structure import Structure, load_structure


@dataclass(frozen=True)
class Damper:
    """a, b: bodies by number; b None: the ground."""

    name: str
    a: int
    b: int | None
    ceiling_mA: int


@dataclass(frozen=True)
class LawRig:
    name: str
    bodies: tuple[str, ...]
    dampers: tuple[Damper, ...]
    signals: frozenset[str]  # "stroke of upper"
    ranges: dict[str, float]  # of measured signals: what their sensors reach, SI
    rate_Hz: int
    structure_file: Path | None
    board_crc32: int  # of its words: what tables name it by

    def input(self, quantity: str, at: int) -> Input:
        """UsageError where the board has no such signal. Limited by its sensor, if it has one."""
        of = self.bodies if BY_NAME[quantity].of == "body" else [d.name for d in self.dampers]
        told = f"{quantity} of {of[at]}"
        if told not in self.signals:
            raise UsageError(
                f"board {self.name} has no {told}; it has: {', '.join(sorted(self.signals))}"
            )
        return Input.of(signal(quantity, at), self.ranges.get(told))

    def structure(self) -> Structure:
        """UsageError where no plant was named, or it has no matrices."""
        if self.structure_file is None:
            raise UsageError("this law is made from the structure's matrices: --plant FILE")
        return load_structure(self.structure_file, self.bodies, [d.name for d in self.dampers])


def load_rig(bench: Bench, board: Path, plant: Path | None, rate_Hz: int) -> LawRig:
    """UsageError where a file is wrong; the plant's is read when it is asked for."""
    data = bench.json("board-check", str(board))
    bodies = tuple(data["bodies"])
    dampers = tuple(
        Damper(one["name"], bodies.index(one["from"]), _end(one["to"], bodies), one["ceiling_mA"])
        for one in data["dampers"]
    )
    ranges = dict(_range_of(one) for one in data["sensors"])
    return LawRig(
        data["name"], bodies, dampers, frozenset(data["signals"]), ranges, rate_Hz, plant,
        data["crc32"],
    )  # fmt: skip


def _end(name: str, bodies: tuple[str, ...]) -> int | None:
    return bodies.index(name) if name in bodies else None


def _range_of(sensor: dict) -> tuple[str, float]:
    """Of its signal; scale is in thousandths of the firmware's unit."""
    quantity = sensor["measures"].replace("_", " ")
    units = 1e-3 * sensor["scale"] * (sensor["full_scale_counts"] + abs(sensor["offset_counts"]))
    return f"{quantity} of {sensor['of']}", units / BY_NAME[quantity].per_unit
