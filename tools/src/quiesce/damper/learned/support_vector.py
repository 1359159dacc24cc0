"""Support-vector regression over what the damper sees now, temperature included where it was
measured. Training by scikit-learn; the kernel's width and the penalty by validation."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from quiesce.base.extras import extra
from quiesce.damper.data.folds import folds_of
from quiesce.damper.data.split import Segment
from quiesce.damper.learned.inputs import Box, input_keys, stacked
from quiesce.damper.learned.model import LearnedDamper, Report, limits_of, silent
from quiesce.damper.library import Scales


@dataclass(frozen=True)
class Settings:
    rows: int = 2500  # most rows to train on
    epsilon: float = 0.01  # of the largest force: errors below it do not count
    penalties: tuple[float, ...] = (10.0, 100.0)  # C of the scaled force
    gammas: tuple[float, ...] = (1.0, 4.0)  # of the scaled inputs
    search_rows: int = 1200


# Of --effort quick, and what stands where time runs out.
BRIEF = Settings(rows=800, penalties=(100.0,), gammas=(1.0,), search_rows=400)


def fitted(u: np.ndarray, force: np.ndarray, penalty: float, gamma: float, epsilon: float) -> Any:
    """scikit-learn's SVR. `force` of about unit size."""
    with extra("learned", "support-vector regression"):
        from sklearn.svm import SVR
    return SVR(kernel="rbf", C=penalty, gamma=gamma, epsilon=epsilon, cache_size=100).fit(u, force)


def chosen(
    segments: Sequence[Segment], box: Box, scales: Scales, settings: Settings, progress: Report
) -> tuple[float, float]:
    """Penalty and gamma with the least error on rows that were not fitted."""
    if len(settings.penalties) == len(settings.gammas) == 1:
        return settings.penalties[0], settings.gammas[0]
    fold = folds_of(segments)[0]
    u, force_N = stacked(fold.fit, box, settings.search_rows)
    u_new, force_new_N = stacked(fold.validation, box, settings.search_rows)
    best = (np.inf, settings.penalties[0], settings.gammas[0])
    for penalty in settings.penalties:
        for gamma in settings.gammas:
            machine = fitted(u, force_N / scales.force_N, penalty, gamma, settings.epsilon)
            error = np.mean((machine.predict(u_new) - force_new_N / scales.force_N) ** 2)
            progress(f"support_vector: C {penalty:g}, gamma {gamma:g}: {np.sqrt(error):.4g}")
            best = min(best, (float(error), penalty, gamma))
    return best[1], best[2]


def train(
    segments: Sequence[Segment],
    scales: Scales,
    seed: int = 0,
    settings: Settings | None = None,
    progress: Report = silent,
) -> LearnedDamper:
    """The seed is not used: nothing is drawn."""
    settings = settings or Settings()
    box = Box.of(segments, input_keys(segments))
    penalty, gamma = chosen(segments, box, scales, settings, progress)
    u, force_N = stacked(segments, box, settings.rows)
    machine = fitted(u, force_N / scales.force_N, penalty, gamma, settings.epsilon)
    parameters = {
        "force_scale_N": float(scales.force_N),
        "gamma": float(gamma),
        "intercept": float(machine.intercept_[0]),
        "coefficients": machine.dual_coef_[0].tolist(),
        "support_vectors": machine.support_vectors_.ravel().tolist(),
        **box.tables(),
    }
    return LearnedDamper(
        "support_vector",
        **limits_of(scales),
        parameters=parameters,
        parameter_count=machine.dual_coef_.size + machine.support_vectors_.size + 2,
        notes=(
            f"{machine.dual_coef_.size} support vectors of {len(u)} rows; penalty {penalty:g} and "
            f"gamma {gamma:g} by validation",
        ),
    )
