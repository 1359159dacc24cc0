"""The controller's picture of a structure, by the names of its board."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from quiesce.engine.board import Board
from quiesce.engine.trace import Trace

VALID_WORDS = ("valid_low", "valid_high")
WORD_BITS = 32


@dataclass(frozen=True)
class Quantity:
    """Of each body or of each damper: a column NAME_column, and its first bit of validity
    (firmware/include/quiesce_valid.h)."""

    column: str
    first_bit: int


ACCEL = Quantity("accel_um_s2", 0)
VELOCITY = Quantity("velocity_um_s", 4)
DISPLACEMENT = Quantity("displacement_nm", 8)
STROKE = Quantity("stroke_nm", 16)
STROKE_VELOCITY = Quantity("velocity_um_s", 20)
FORCE = Quantity("force_mN", 24)
CURRENT = Quantity("current_mA", 28)
VOLTAGE = Quantity("voltage_mV", 32)
TEMPERATURE = Quantity("temperature_mdegC", 36)
OF_BODIES = (ACCEL, VELOCITY, DISPLACEMENT)
OF_DAMPERS = (STROKE, STROKE_VELOCITY, FORCE, CURRENT, VOLTAGE, TEMPERATURE)
COMMANDS = ("current_law_mA", "current_cmd_mA")


def columns(board: Board) -> list[str]:
    """All of it, as the bench names them."""
    of_bodies = [f"{body}_{one.column}" for body in board.bodies for one in OF_BODIES]
    of_damper = [*(one.column for one in OF_DAMPERS), *COMMANDS]
    of_dampers = [f"{damper}_{column}" for damper in board.dampers for column in of_damper]
    return [*VALID_WORDS, *of_bodies, *of_dampers]


def is_valid(trace: Trace, quantity: Quantity, number: int) -> np.ndarray:
    """Of each tick: whether the quantity of this body or damper is."""
    word, bit = divmod(quantity.first_bit + number, WORD_BITS)
    return (trace[VALID_WORDS[word]].astype(np.int64) >> bit & 1) > 0


def curve(trace: Trace, names: tuple[str, ...], number: int, quantity: Quantity) -> np.ndarray:
    """Of body or damper `number` of these; NaN where it is not valid."""
    values = trace[f"{names[number]}_{quantity.column}"]
    return np.where(is_valid(trace, quantity, number), values, np.nan)


def extent(values: np.ndarray, unit_per_one: float) -> dict[str, float | None]:
    """RMS and peak of what is valid; None where nothing is."""
    known = values[np.isfinite(values)] * unit_per_one
    if known.size == 0:
        return {"rms": None, "peak": None}
    rms = float(np.sqrt(np.mean(known**2)))
    return {"rms": round(rms, 6), "peak": round(float(np.abs(known).max()), 6)}


def body_figures(trace: Trace, board: Board) -> dict[str, dict[str, Any]]:
    def of_body(number: int) -> dict[str, Any]:
        parts = {}
        for name, unit, quantity, scale in (
            ("accel", "m_s2", ACCEL, 1e-6),
            ("disp", "mm", DISPLACEMENT, 1e-6),
        ):
            found = extent(curve(trace, board.bodies, number, quantity), scale)
            parts |= {f"{name}_{kind}_{unit}": value for kind, value in found.items()}
        return parts

    return {body: of_body(number) for number, body in enumerate(board.bodies)}


def damper_figures(trace: Trace, board: Board) -> dict[str, dict[str, Any]]:
    def of_damper(number: int, name: str) -> dict[str, Any]:
        command_mA = trace[f"{name}_current_cmd_mA"]
        stroke = extent(curve(trace, board.dampers, number, STROKE), 1e-6)
        return {
            "mean_current_A": round(1e-3 * float(command_mA.mean()), 4),
            "max_current_A": round(1e-3 * float(command_mA.max()), 4),
            **{f"stroke_{kind}_mm": value for kind, value in stroke.items()},
        }

    return {name: of_damper(number, name) for number, name in enumerate(board.dampers)}
