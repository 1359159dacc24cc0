"""Small networks in numpy: tanh layers, the last one linear, with gradients and Adam."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np


@dataclass
class Network:
    """weights[l] is [units, inputs] of layer l, biases[l] is [units]."""

    weights: list[np.ndarray]
    biases: list[np.ndarray]

    @staticmethod
    def random(sizes: Sequence[int], rng: np.random.Generator) -> "Network":
        """sizes: inputs, hidden layers, outputs."""
        pairs = list(zip(sizes[:-1], sizes[1:], strict=True))
        return Network(
            [rng.normal(size=(units, inputs)) / np.sqrt(inputs) for inputs, units in pairs],
            [np.zeros(units) for _, units in pairs],
        )

    @property
    def values(self) -> list[np.ndarray]:
        """All parameters, layer by layer; the arrays themselves."""
        return [one for pair in zip(self.weights, self.biases, strict=True) for one in pair]

    @property
    def parameter_count(self) -> int:
        return sum(one.size for one in self.values)

    def forward(self, inputs: np.ndarray) -> list[np.ndarray]:
        """Every layer's values, the inputs first and the outputs last, each [rows, units]."""
        layers = [inputs]
        last = len(self.weights) - 1
        for k, (weights, biases) in enumerate(zip(self.weights, self.biases, strict=True)):
            sums = layers[-1] @ weights.T + biases
            layers.append(sums if k == last else np.tanh(sums))
        return layers

    def __call__(self, inputs: np.ndarray) -> np.ndarray:
        return self.forward(inputs)[-1]

    def backward(
        self, layers: list[np.ndarray], by_output: np.ndarray
    ) -> tuple[list[np.ndarray], np.ndarray]:
        """Gradients of `values`, and by the inputs, from that by the outputs of `forward`."""
        gradients: list[np.ndarray] = []
        flow = by_output
        for k in range(len(self.weights) - 1, -1, -1):
            gradients = [flow.T @ layers[k], flow.sum(axis=0), *gradients]
            flow = flow @ self.weights[k]
            if k > 0:
                flow = flow * (1.0 - layers[k] ** 2)
        return gradients, flow

    def tables(self) -> list[dict]:
        """[[layer]] of a file."""
        return [
            {"units": len(biases), "weights": weights.ravel().tolist(), "biases": biases.tolist()}
            for weights, biases in zip(self.weights, self.biases, strict=True)
        ]

    def copy(self) -> "Network":
        return Network([one.copy() for one in self.weights], [one.copy() for one in self.biases])


class Adam:
    """Steps of the parameters in place; weight decay on matrices only."""

    def __init__(self, values: Sequence[np.ndarray], decay: float = 0.0) -> None:
        self._values = list(values)
        self._decay = decay
        self._mean = [np.zeros_like(one) for one in values]
        self._square = [np.zeros_like(one) for one in values]
        self._count = 0

    def step(self, gradients: Sequence[np.ndarray], rate: float) -> None:
        self._count += 1
        for value, gradient, mean, square in zip(
            self._values, gradients, self._mean, self._square, strict=True
        ):
            mean += 0.1 * (gradient - mean)
            square += 0.001 * (gradient**2 - square)
            unbiased = mean / (1.0 - 0.9**self._count)
            size = np.sqrt(square / (1.0 - 0.999**self._count)) + 1e-8
            value -= rate * (unbiased / size + (self._decay * value if value.ndim > 1 else 0.0))


def falling_rate(first: float, part: float) -> float:
    """Half a cosine from `first` to 0 as part goes from 0 to 1."""
    return 0.5 * first * (1.0 + np.cos(np.pi * min(part, 1.0)))


def fit(
    network: Network,
    inputs: np.ndarray,
    targets: np.ndarray,
    rng: np.random.Generator,
    epochs: int = 80,
    batch: int = 64,
    rate: float = 4e-3,
    decay: float = 1e-3,
) -> None:
    """Least squares of targets [rows, outputs] by Adam, in place."""
    adam = Adam(network.values, decay)
    batches = max(1, len(inputs) // batch)
    for epoch in range(epochs):
        order = rng.permutation(len(inputs))
        for k in range(batches):
            rows = order[k * batch : (k + 1) * batch]
            layers = network.forward(inputs[rows])
            gradients, _ = network.backward(layers, (layers[-1] - targets[rows]) / len(rows))
            adam.step(gradients, falling_rate(rate, (epoch + k / batches) / epochs))


def fitted(
    inputs: np.ndarray,
    targets: np.ndarray,
    hidden: Sequence[int],
    rng: np.random.Generator,
    epochs: int,
    decay: float,
) -> tuple[Network, float]:
    """A network of one output from chance, its start the mean, fitted to targets [rows] by inputs
    [rows, inputs]; and its root mean square error, in the targets' unit."""
    network = Network.random((inputs.shape[1], *hidden, 1), rng)
    network.biases[-1][:] = targets.mean()
    fit(network, inputs, targets[:, None], rng, epochs, decay=decay)
    return network, float(np.sqrt(np.mean((network(inputs)[:, 0] - targets) ** 2)))
