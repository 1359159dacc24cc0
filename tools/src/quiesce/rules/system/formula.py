"""Formulas as trees: names, numbers, and functions of other formulas."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

# Of one formula; NEGATE is written as a sign.
NEGATE = "negate"
FUNCTIONS: dict[str, Callable] = {
    "abs": np.abs, "fabs": np.abs, "sqrt": np.sqrt, "exp": np.exp, "log": np.log,
    "log10": np.log10, "sin": np.sin, "cos": np.cos, "tan": np.tan, "asin": np.arcsin,
    "acos": np.arccos, "atan": np.arctan, "sinh": np.sinh, "cosh": np.cosh, "tanh": np.tanh,
    "floor": np.floor, "ceil": np.ceil, "round": np.round,
}  # fmt: skip
FUNCTIONS_OF_TWO: dict[str, Callable] = {
    "pow": np.power, "atan2": np.arctan2, "fmod": np.fmod, "max": np.maximum, "min": np.minimum,
    "lt": lambda a, b: 1.0 * (a < b), "gt": lambda a, b: 1.0 * (a > b),
    "le": lambda a, b: 1.0 * (a <= b), "ge": lambda a, b: 1.0 * (a >= b),
    "eq": lambda a, b: 1.0 * (a == b), "neq": lambda a, b: 1.0 * (a != b),
}  # fmt: skip
SUMS = {"+": np.add, "-": np.subtract}
PRODUCTS = {"*": np.multiply, "/": np.divide, "%": np.fmod}
POWER = "^"
MEANINGS: dict[str, Callable] = {
    NEGATE: np.negative, POWER: np.power, **SUMS, **PRODUCTS, **FUNCTIONS, **FUNCTIONS_OF_TWO,
}  # fmt: skip


@dataclass(frozen=True)
class Number:
    value: float


@dataclass(frozen=True)
class Name:
    text: str


@dataclass(frozen=True)
class Apply:
    """word: of MEANINGS."""

    word: str
    parts: tuple["Tree", ...]


Tree = Number | Name | Apply


def names_of(tree: Tree) -> frozenset[str]:
    if isinstance(tree, Name):
        return frozenset([tree.text])
    parts = tree.parts if isinstance(tree, Apply) else ()
    return frozenset(name for part in parts for name in names_of(part))


def value_of(tree: Tree, values: Mapping[str, np.ndarray]) -> np.ndarray:
    """values: of each name."""
    if isinstance(tree, Number):
        return np.asarray(tree.value)
    if isinstance(tree, Name):
        return np.asarray(values[tree.text], dtype=float)
    with np.errstate(all="ignore"):
        return MEANINGS[tree.word](*(value_of(part, values) for part in tree.parts))
