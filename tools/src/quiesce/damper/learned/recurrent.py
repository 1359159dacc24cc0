"""Recurrent network: its own earlier forces are among its inputs.

Trained twice: with the measured forces fed back (series-parallel), then with its own over short
windows (free-running, gradients through time). It is scored, and used, free-running only.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from quiesce.damper.data.split import Segment
from quiesce.damper.learned.inputs import Box
from quiesce.damper.learned.model import LearnedDamper, Report, limits_of, named, silent
from quiesce.damper.learned.sampled import Series, default_lags, sample_time_s, series_of
from quiesce.damper.library import Scales
from quiesce.network.dense import Adam, Network, falling_rate, fit

Limits = tuple[float, float]  # of what is fed back, in parts of the largest
FREE: Limits = (-np.inf, np.inf)


@dataclass(frozen=True)
class Settings:
    hidden: tuple[int, ...] = (16,)
    feedback: tuple[int, ...] = (1, 2)  # of the force, in samples
    lags: tuple[int, ...] | None = None  # of the inputs; None: 0, 1, 2, 4, ... up to 30 ms
    sample_time_s: float | None = None  # None: that of the data
    epochs: int = 30  # series-parallel
    window: int = 40  # samples that run free while gradients go through time
    windows: int = 32  # in a step
    free_steps: int = 600
    noise: float = 0.02  # on the forces fed back at first, of the largest force
    decay: float = 1e-3


# Of --effort quick, and what stands where time runs out.
BRIEF = Settings(epochs=8, free_steps=100)


def earlier(force: np.ndarray, feedback: Sequence[int]) -> np.ndarray:
    """Delayed forces [samples, feedback]; 0 before the first."""
    padded = np.concatenate([np.zeros(max(feedback)), force])
    first = max(feedback)
    return np.stack([padded[first - lag : first - lag + len(force)] for lag in feedback], axis=1)


def free_run(
    network: Network,
    inputs: np.ndarray,
    feedback: Sequence[int],
    limits: Limits = FREE,
) -> np.ndarray:
    """Forces [samples] from rest, only the network's own fed back; within the limits."""
    depth = max(feedback)
    out = np.zeros(len(inputs) + depth)
    back = np.array(feedback)
    for k, row in enumerate(inputs):
        seen = np.concatenate([row, out[k + depth - back]])
        for weights, biases in zip(network.weights[:-1], network.biases[:-1], strict=True):
            seen = np.tanh(weights @ seen + biases)
        force = network.weights[-1][0] @ seen + network.biases[-1][0]
        out[k + depth] = min(max(force, limits[0]), limits[1])
    return out[depth:]


def free_error(
    network: Network, series: Sequence[Series], feedback: Sequence[int], limits: Limits = FREE
) -> float:
    """Root mean square over what is to be learned, in parts of the largest, as `free_run` has it
    within these limits."""
    errors = [
        (free_run(network, one.inputs, feedback, limits) - one.target)[one.first :]
        for one in series
    ]
    return float(np.sqrt(np.mean(np.concatenate(errors) ** 2)))


def window_gradient(
    network: Network, inputs: np.ndarray, force: np.ndarray, feedback: Sequence[int]
) -> tuple[float, list[np.ndarray]]:
    """Error and gradients of a batch of windows. inputs [windows, depth + window, inputs] and
    force [windows, depth + window], of which the first depth = max(feedback) are given."""
    depth, count = max(feedback), force.shape[1]
    back = np.array(feedback)
    run = force.copy()
    layers = []
    for k in range(depth, count):
        layers.append(network.forward(np.concatenate([inputs[:, k], run[:, k - back]], axis=1)))
        run[:, k] = layers[-1][-1][:, 0]
    scale = 1.0 / (len(force) * (count - depth))
    by_force = scale * (run - force)
    total = [np.zeros_like(one) for one in network.values]
    width = inputs.shape[2]
    for k in range(count - 1, depth - 1, -1):
        gradients, by_inputs = network.backward(layers[k - depth], by_force[:, k, None])
        for sum_, gradient in zip(total, gradients, strict=True):
            sum_ += gradient
        for j, lag in enumerate(feedback):
            by_force[:, k - lag] += by_inputs[:, width + j]
    return 0.5 * scale * float(np.sum((run - force)[:, depth:] ** 2)), total


def drawn_windows(
    series: Sequence[Series], settings: Settings, rng: np.random.Generator
) -> tuple[np.ndarray, np.ndarray]:
    length = max(settings.feedback) + settings.window
    long_enough = [one for one in series if len(one) - one.first >= length]
    sizes = np.array([len(one) - one.first for one in long_enough], dtype=float)
    inputs, force = [], []
    for index in rng.choice(len(long_enough), settings.windows, p=sizes / sizes.sum()):
        one = long_enough[index]
        at = int(rng.integers(one.first, len(one) - length + 1))
        inputs.append(one.inputs[at : at + length])
        force.append(one.target[at : at + length])
    return np.stack(inputs), np.stack(force)


def clipped(gradients: list[np.ndarray], most: float = 0.1) -> list[np.ndarray]:
    size = np.sqrt(sum(float(np.sum(one**2)) for one in gradients))
    return [one * min(1.0, most / (size + 1e-300)) for one in gradients]


def tune_free(
    network: Network,
    series: Sequence[Series],
    settings: Settings,
    rng: np.random.Generator,
    report: Report,
    limits: Limits,
) -> tuple[Network, float]:
    """The best of the networks seen while training free-running, and its error within the limits;
    the training itself has none."""
    best, best_error = network.copy(), free_error(network, series, settings.feedback, limits)
    length = max(settings.feedback) + settings.window
    if not any(len(one) - one.first >= length for one in series):
        return best, best_error
    adam = Adam(network.values, settings.decay)
    for step in range(settings.free_steps):
        _, gradients = window_gradient(
            network, *drawn_windows(series, settings, rng), settings.feedback
        )
        adam.step(clipped(gradients), falling_rate(3e-3, step / settings.free_steps))
        if step % 100 == 99:
            error = free_error(network, series, settings.feedback, limits)
            report(f"step {step + 1}, free-running error {error:.4g}")
            if error < best_error:
                best, best_error = network.copy(), error
    return best, best_error


@dataclass(frozen=True)
class Learned:
    """Free-running errors, in parts of the largest: with measured values fed back in training, then
    at the end."""

    network: Network
    start: float
    error: float


def learned(
    series: Sequence[Series],
    settings: Settings,
    rng: np.random.Generator,
    report: Report,
    limits: Limits = FREE,
) -> Learned:
    """Both trainings; errors are of the network as it runs within the limits."""
    fed_back = [earlier(one.target, settings.feedback)[one.first :] for one in series]
    inputs = np.concatenate([one.inputs[one.first :] for one in series])
    force = np.concatenate([one.target[one.first :] for one in series])
    noisy = np.concatenate(fed_back)
    noisy = noisy + settings.noise * rng.normal(size=noisy.shape)
    seen = np.concatenate([inputs, noisy], axis=1)
    network = Network.random((seen.shape[1], *settings.hidden, 1), rng)
    fit(network, seen, force[:, None], rng, settings.epochs, decay=settings.decay)
    start = free_error(network, series, settings.feedback, limits)
    network, error = tune_free(network, series, settings, rng, report, limits)
    return Learned(network, start, error)


def train(
    segments: Sequence[Segment],
    scales: Scales,
    seed: int = 0,
    settings: Settings | None = None,
    progress: Report = silent,
) -> LearnedDamper:
    settings = settings or Settings()
    rng = np.random.default_rng(seed)
    time_s = settings.sample_time_s or sample_time_s(segments)
    lags = settings.lags or default_lags(time_s)
    box = Box.of(segments)
    series = series_of(segments, box, lags, time_s, lambda one: one.force_N / scales.force_N)
    found = learned(series, settings, rng, named("recurrent_network", progress))
    parameters = {
        "force_scale_N": float(scales.force_N),
        "sample_time_s": float(time_s),
        "lags": list(lags),
        "feedback": list(settings.feedback),
        **box.tables(),
        "layer": found.network.tables(),
    }
    return LearnedDamper(
        "recurrent_network",
        **limits_of(scales),
        parameters=parameters,
        parameter_count=found.network.parameter_count,
        notes=(
            f"free-running error {found.start:.4g} of the largest force after training with "
            f"measured forces, {found.error:.4g} after training free-running",
        ),
    )
