"""ANFIS: zero-order Takagi-Sugeno on a grid of Gaussians, trained by the hybrid method.

Forward, the consequents follow from the premises by least squares; backward, centres and widths go
down the gradient. A step that does not lower the error is taken back and halved. Scaled inputs
u in -1 .. 1; z in N. Source: thesis on the RD-8040-1 (product of Gaussians, weighted mean).
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from quiesce.damper.data.split import Segment
from quiesce.damper.learned.inputs import Box, input_keys, stacked
from quiesce.damper.learned.model import LearnedDamper, Report, limits_of, silent
from quiesce.damper.library import Scales

# Half width at half height of a Gaussian, in its standard deviation.
_HALF_WIDTH = 1.1774
_LEAST_WIDTH = 0.03
_STEP_GROWTH = 1.3
_LEAST_STEP = 1e-6


@dataclass(frozen=True)
class Settings:
    memberships: int = 3  # of each input
    epochs: int = 120
    ridge: float = 1e-6  # of the mean square of the weights
    first_step: float = 0.02  # of the premises, scaled


# Of --effort quick, and what stands where time runs out.
BRIEF = Settings(epochs=20)


@dataclass(frozen=True)
class Premises:
    """centres and widths [inputs, memberships], scaled."""

    centres: np.ndarray
    widths: np.ndarray

    @staticmethod
    def grid(inputs: int, memberships: int) -> "Premises":
        """Even centres over -1 .. 1, neighbours crossing at half height."""
        centres = np.linspace(-1.0, 1.0, memberships)
        width = 2.0 / (memberships - 1) / (2.0 * _HALF_WIDTH)
        return Premises(np.tile(centres, (inputs, 1)), np.full((inputs, memberships), width))

    def grades(self, u: np.ndarray) -> np.ndarray:
        """Memberships relative to the nearest, [rows, inputs, memberships]."""
        exponents = -0.5 * ((u[:, :, None] - self.centres) / self.widths) ** 2
        return np.exp(exponents - exponents.max(axis=2, keepdims=True))

    def weights(self, u: np.ndarray) -> np.ndarray:
        """Normalised weights of the rules, the last input's membership fastest, [rows, rules]."""
        grades = self.grades(u)
        out = np.ones((len(u), 1))
        for k in range(grades.shape[1]):
            out = (out[:, :, None] * grades[:, k, None, :]).reshape(len(u), -1)
        return out / out.sum(axis=1, keepdims=True)


def consequents(weights: np.ndarray, force: np.ndarray, ridge: float) -> np.ndarray:
    """Least squares of force = weights z, [rules]."""
    rules = weights.shape[1]
    gram = weights.T @ weights
    return np.linalg.solve(gram + ridge * np.trace(gram) / rules * np.eye(rules), weights.T @ force)


def premise_gradient(
    premises: Premises, u: np.ndarray, z: np.ndarray, force: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Gradients of mean((F - force)^2) / 2 by centres and widths, both [inputs, memberships]."""
    weights = premises.weights(u)
    model = weights @ z
    by_rule = (model - force)[:, None] * weights * (z - model[:, None]) / len(u)
    count = premises.centres.shape[1]
    shape = (len(u),) + (count,) * len(premises.centres)
    by_rule = by_rule.reshape(shape)
    centres, widths = np.empty_like(premises.centres), np.empty_like(premises.widths)
    for k in range(len(premises.centres)):
        others = tuple(axis for axis in range(1, len(shape)) if axis != k + 1)
        shared = by_rule.sum(axis=others)
        distance = u[:, k, None] - premises.centres[k]
        centres[k] = np.sum(shared * distance / premises.widths[k] ** 2, axis=0)
        widths[k] = np.sum(shared * distance**2 / premises.widths[k] ** 3, axis=0)
    return centres, widths


def error_of(premises: Premises, u: np.ndarray, force: np.ndarray, ridge: float) -> float:
    """Root mean square with the best consequents."""
    weights = premises.weights(u)
    return float(np.sqrt(np.mean((weights @ consequents(weights, force, ridge) - force) ** 2)))


def hybrid(
    u: np.ndarray,
    force: np.ndarray,
    settings: Settings,
    report: Report = silent,
    start: Premises | None = None,
) -> tuple[Premises, np.ndarray, list[float]]:
    """Premises, consequents and the error after each accepted step, the start first. `force` of
    about unit size. start: other than a grid over -1 .. 1; then u, and the steps, are in its
    units."""
    premises = start or Premises.grid(u.shape[1], settings.memberships)
    errors = [error_of(premises, u, force, settings.ridge)]
    step = settings.first_step
    for epoch in range(settings.epochs):
        z = consequents(premises.weights(u), force, settings.ridge)
        gradient = premise_gradient(premises, u, z, force)
        size = np.sqrt(sum(np.sum(part**2) for part in gradient)) + 1e-300
        while step > _LEAST_STEP:
            trial = Premises(
                premises.centres - step / size * gradient[0],
                np.maximum(premises.widths - step / size * gradient[1], _LEAST_WIDTH),
            )
            error = error_of(trial, u, force, settings.ridge)
            if error < errors[-1]:
                premises, step = trial, _STEP_GROWTH * step
                errors.append(error)
                break
            step *= 0.5
        if step <= _LEAST_STEP:
            break
        if epoch % 20 == 19:
            report(f"anfis: epoch {epoch + 1} of {settings.epochs}, error {errors[-1]:.4g}")
    return premises, consequents(premises.weights(u), force, settings.ridge), errors


def train(
    segments: Sequence[Segment],
    scales: Scales,
    seed: int = 0,
    settings: Settings | None = None,
    progress: Report = silent,
) -> LearnedDamper:
    """Nine rules where the current is constant, else 27 with three memberships an input. The seed
    is not used: nothing is drawn."""
    settings = settings or Settings()
    box = Box.of(segments, input_keys(segments))
    u, force_N = stacked(segments, box)
    premises, z, errors = hybrid(u, force_N / scales.force_N, settings, progress)
    parameters = parameters_of(box, premises, z * scales.force_N)
    return LearnedDamper(
        "anfis",
        **limits_of(scales),
        parameters=parameters,
        parameter_count=z.size + 2 * premises.centres.size,
        notes=(
            f"{z.size} rules; {len(errors) - 1} steps of the premises lowered the error from "
            f"{errors[0]:.4g} to {errors[-1]:.4g} of the largest force",
        ),
    )


def parameters_of(box: Box, premises: Premises, z_N: np.ndarray) -> dict:
    tables = box.tables()
    for k, key in enumerate(box.keys):
        half = 0.5 * (box.high[k] - box.low[k])
        tables[key]["centres"] = (box.low[k] + half * (premises.centres[k] + 1.0)).tolist()
        tables[key]["widths"] = (half * premises.widths[k]).tolist()
    return {"consequents_N": z_N.tolist(), **tables}
