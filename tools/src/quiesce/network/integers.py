"""Fitted networks in integers: 24 bits a weight, with an exponent a row."""

import numpy as np

from quiesce.network.dense import Network
from quiesce.network.layers import (
    CENTRE_LIMIT,
    MOST_OUTPUT_SHIFT,
    MOST_SHIFT,
    ONE,
    SHARP_ONE,
    WEIGHT_LIMIT,
    Dense,
    Layers,
    Output,
    Radial,
)


def with_shift(values: np.ndarray, most: int = MOST_SHIFT) -> tuple[int, tuple[int, ...]]:
    """The largest shift that keeps all below 2^24, and the integers. ValueError where none does."""
    largest = float(np.abs(values).max())
    if not largest < WEIGHT_LIMIT - 1:
        raise ValueError(f"a weight of {largest:.3g} is beyond 2^24")
    shift = most
    if largest > 0.0:
        shift = min(most, int(np.floor(np.log2((WEIGHT_LIMIT - 1) / largest))))
    return shift, tuple(int(value) for value in np.rint(np.ldexp(values, shift)))


def dense_layer(weights: np.ndarray, biases: np.ndarray) -> Dense:
    """tanh of weights [units values] and biases [units]."""
    rows = []
    for row in np.column_stack([biases, weights]):
        shift, integers = with_shift(row)
        rows.append((shift, *integers))
    return Dense(True, tuple(rows))


def radial_layer(centres: np.ndarray, sharpnesses: np.ndarray, is_normalised: bool) -> Radial:
    """exp(-sum of ((x - centre) sharpness)^2), both [units values]."""
    at = np.clip(np.rint(centres * ONE), -CENTRE_LIMIT, CENTRE_LIMIT)
    sharp = np.clip(np.rint(sharpnesses * SHARP_ONE), 0, WEIGHT_LIMIT - 1)
    return Radial(
        is_normalised,
        tuple(tuple(int(v) for v in row) for row in at),
        tuple(tuple(int(v) for v in row) for row in sharp),
    )


def output_of(bias_mA: float, coefficients_mA: np.ndarray) -> Output:
    """coefficients [units], or [units (1 + values)]."""
    every = np.concatenate([[bias_mA], coefficients_mA.ravel()])
    shift, integers = with_shift(every, MOST_OUTPUT_SHIFT)
    return Output(int(coefficients_mA.ndim > 1), shift, integers[0], integers[1:])


def of_dense(network: Network, unit_mA: float) -> Layers:
    """A network whose one output counts in unit_mA."""
    pairs = list(zip(network.weights, network.biases, strict=True))
    hidden = tuple(dense_layer(*pair) for pair in pairs[:-1])
    weights, biases = pairs[-1]
    return Layers(hidden, output_of(unit_mA * biases[0], unit_mA * weights[0]))
