"""A structure as a plant file has it, and where things are on it."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
GROUND = "ground"


@dataclass(frozen=True)
class Structure:
    """lines: of the plant file, [structure] and [[place]]."""

    what: str  # one line for people
    lines: list[str]
    bodies: tuple[str, ...]  # places of the plant file, bodies of the board
    freqs_Hz: list[float]  # of its modes, without the damper
    damper_ends: tuple[str, str]  # a body, and another one or GROUND
    lever: float  # stroke for 1 m between these ends
    sensors: tuple[str, ...]  # bodies with an accelerometer; the first one is tracked


def number(value: float) -> str:
    """For TOML: ten digits, always a real number."""
    text = f"{value:.10g}"
    return text if any(mark in text for mark in ".en") else f"{text}.0"


def row(values: Floats | list[float]) -> str:
    return f"[{', '.join(number(float(value)) for value in values)}]"


def place_lines(name: str, at: Floats | list[float]) -> list[str]:
    return ["", "[[place]]", f'name = "{name}"', f"at = {row(at)}"]
