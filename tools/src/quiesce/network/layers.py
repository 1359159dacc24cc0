"""Networks in integers, as the controller works them off, and in float64 what the integers stand
for.

firmware/base/network.h describes the words. Values are within -1 .. 1.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

MOST_INPUTS, MOST_UNITS, MOST_LAYERS = 8, 32, 2
MOST_SHIFT, MOST_OUTPUT_SHIFT = 60, 36
WEIGHT_LIMIT = 2**24  # of a magnitude, itself excluded
ONE = 2**24  # of values and centres
CENTRE_LIMIT = 4 * ONE
SHARP_ONE = 2**16
_FAR = 128.0  # of a side, and of a whole distance
MOST_WORK = 5000  # instructions of a table
DENSE_TANH, DENSE_LINE, RADIAL, RADIAL_NORMALISED = range(4)

Take = Callable[[int], list[int]]
"""So many words; ValueError where there are no more."""


@dataclass(frozen=True)
class Dense:
    """Units of rows {shift, bias, weights}."""

    is_tanh: bool
    rows: tuple[tuple[int, ...], ...]

    def words(self) -> list[int]:
        kind = DENSE_TANH if self.is_tanh else DENSE_LINE
        return [kind, len(self.rows), *(word for row in self.rows for word in row)]

    def values(self, x: np.ndarray) -> np.ndarray:
        """[ticks units] for [ticks values]."""
        rows = np.array(self.rows, dtype=float)
        sums = (rows[:, 1] + x @ rows[:, 2:].T) * 2.0 ** -rows[:, 0]
        return np.tanh(sums) if self.is_tanh else np.clip(sums, -1.0, 1.0)

    @property
    def units(self) -> int:
        return len(self.rows)

    @property
    def work(self) -> int:
        """Instructions, about."""
        return len(self.rows) * (140 + 8 * (len(self.rows[0]) - 2))


@dataclass(frozen=True)
class Radial:
    """Gaussians of centres [units values] in 2^-24 and sharpnesses in 2^-16."""

    is_normalised: bool
    centres: tuple[tuple[int, ...], ...]
    sharpnesses: tuple[tuple[int, ...], ...]

    def words(self) -> list[int]:
        kind = RADIAL_NORMALISED if self.is_normalised else RADIAL
        units = zip(self.centres, self.sharpnesses, strict=True)
        return [kind, len(self.centres), *(word for pair in units for row in pair for word in row)]

    def values(self, x: np.ndarray) -> np.ndarray:
        """[ticks units] for [ticks values]."""
        centres = np.array(self.centres) / ONE
        sharpnesses = np.array(self.sharpnesses) / SHARP_ONE
        sides = np.clip((x[:, None, :] - centres) * sharpnesses, -_FAR, _FAR)
        distances = np.minimum(np.sum(sides**2, axis=2), _FAR)
        if not self.is_normalised:
            return np.exp(-distances)
        near = np.exp(distances.min(axis=1, keepdims=True) - distances)
        return near / near.sum(axis=1, keepdims=True)

    @property
    def units(self) -> int:
        return len(self.centres)

    @property
    def work(self) -> int:
        """Instructions, about."""
        of_unit = 90 + 30 * len(self.centres[0]) + (35 if self.is_normalised else 0)
        return len(self.centres) * of_unit


Layer = Dense | Radial


@dataclass(frozen=True)
class Output:
    """In mA: coefficients [units], or [units (1 + values)] with order 1."""

    order: int
    shift: int
    bias: int
    coefficients: tuple[int, ...]

    def words(self) -> list[int]:
        return [self.order, self.shift, self.bias, *self.coefficients]

    def sums_mA(self, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        """[ticks], not limited, of the last layer's y [ticks units] on x [ticks values]."""
        rules = np.array(self.coefficients, dtype=float).reshape(y.shape[1], -1)
        parts = rules[:, 0] + (x @ rules[:, 1:].T if self.order else 0.0)
        return (self.bias + np.sum(y * parts, axis=1)) * 2.0**-self.shift


@dataclass(frozen=True)
class Layers:
    """From values to a current."""

    layers: tuple[Layer, ...]
    output: Output

    def words(self) -> list[int]:
        return [
            *(word for layer in self.layers for word in layer.words()),
            *self.output.words(),
        ]

    def sums_mA(self, x: np.ndarray) -> np.ndarray:
        """[ticks] for [ticks values], not limited, in float64."""
        seen = made = x
        for layer in self.layers:
            seen, made = made, layer.values(made)
        return self.output.sums_mA(seen, made)

    @property
    def work(self) -> int:
        """Instructions, about."""
        return sum(layer.work for layer in self.layers) + 8 * len(self.output.coefficients)


def read_layers(take: Take, values: int, count: int) -> Layers:
    """Of `count` layers on `values` values. ValueError, in one line, where the firmware refuses
    them."""
    layers: list[Layer] = []
    seen = values
    for _ in range(count):
        seen = values
        layers.append(_read_layer(take, values))
        values = layers[-1].units
    order, shift, bias = take(3)
    if order not in (0, 1):
        raise ValueError(f"order {order} of an output is not 0 or 1")
    _require_shift(shift, MOST_OUTPUT_SHIFT)
    coefficients = take(values * (1 + order * seen))
    _require_below([bias, *coefficients], WEIGHT_LIMIT, "a coefficient")
    return Layers(tuple(layers), Output(order, shift, bias, tuple(coefficients)))


def _read_layer(take: Take, values: int) -> Layer:
    kind, units = take(2)
    if not DENSE_TANH <= kind <= RADIAL_NORMALISED:
        raise ValueError(f"{kind} is no kind of layer")
    if not 1 <= units <= MOST_UNITS:
        raise ValueError(f"{units} units of a layer are not in 1 .. {MOST_UNITS}")
    if kind in (DENSE_TANH, DENSE_LINE):
        rows = [take(2 + values) for _ in range(units)]
        for row in rows:
            _require_shift(row[0])
            _require_below(row[1:], WEIGHT_LIMIT, "a weight")
        return Dense(kind == DENSE_TANH, tuple(tuple(row) for row in rows))
    pairs = [(take(values), take(values)) for _ in range(units)]
    for centres, sharpnesses in pairs:
        _require_below(centres, CENTRE_LIMIT + 1, "a centre")
        _require_below(sharpnesses, WEIGHT_LIMIT, "a sharpness")
        if min(sharpnesses) < 0:
            raise ValueError("a sharpness below 0")
    return Radial(
        kind == RADIAL_NORMALISED,
        tuple(tuple(one) for one, _ in pairs),
        tuple(tuple(one) for _, one in pairs),
    )


def _require_shift(shift: int, most: int = MOST_SHIFT) -> None:
    if not 0 <= shift <= most:
        raise ValueError(f"shift {shift} is not in 0 .. {most}")


def _require_below(values: Sequence[int], limit: int, what: str) -> None:
    if any(abs(value) >= limit for value in values):
        raise ValueError(f"{what} of {limit} or more")
