"""Feed-forward inverse network: i(t) = N(F, x, v at t and earlier).

Source: review of MR damper models, eq 38 (taps t and t-1); its text gives no sizes.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from quiesce.damper.data.record import Record
from quiesce.damper.inverses.compiled import COMPILED
from quiesce.damper.inverses.demand import Source, checked_levels
from quiesce.damper.inverses.keys import box_of, lags_of, network_of, number
from quiesce.damper.inverses.taps import (
    INPUTS,
    LEAST_SPEED,
    held,
    largest_speed_m_s,
    spread,
    taught_rows,
)
from quiesce.damper.learned.inputs import Box
from quiesce.damper.learned.model import Report, silent
from quiesce.damper.learned.sampled import delayed, sample_time_s, sampled_rows, series_of
from quiesce.network.dense import Network, fitted

NAME = "ffn"
TITLE = "feed-forward inverse network (eq 38)"
HELP = "feed-forward network over force, displacement and velocity, now and before"
TRACKER = COMPILED


@dataclass(frozen=True)
class Settings:
    hidden: tuple[int, ...] = (24, 12)
    lags: tuple[int, ...] = (0, 1)  # in samples
    sample_time_s: float | None = None  # None: that of the data
    most_rows: int = 12_000
    epochs: int = 80
    decay: float = 1e-3


@dataclass(frozen=True)
class FeedForwardInverse:
    """Inputs are cut off at the range of the training."""

    box: Box
    lags: tuple[int, ...]
    sample_time_s: float
    least_speed_m_s: float
    max_current_A: float
    network: Network

    def currents(self, demand: Record) -> np.ndarray:
        rows = sampled_rows(demand, self.sample_time_s)
        inputs = delayed(self.box.picked(demand)[rows], self.box, self.lags)
        current_A = self.max_current_A * np.clip(self.network(inputs)[:, 0], 0.0, 1.0)
        kept = held(current_A, demand.velocity_m_s[rows], self.least_speed_m_s)
        return spread(kept, rows, len(demand))

    def steady_A(self, force_N: np.ndarray, velocity_m_s: float) -> np.ndarray:
        """Current in mid-stroke for forces that last, [forces]."""
        one = np.stack(
            [force_N, np.zeros(len(force_N)), np.full(len(force_N), velocity_m_s)], axis=1
        )
        inputs = np.tile(self.box.scaled(one), (1, len(self.lags)))
        return self.max_current_A * np.clip(self.network(inputs)[:, 0], 0.0, 1.0)

    def parameters(self) -> dict[str, Any]:
        return {
            "sample_time_s": self.sample_time_s,
            "lags": list(self.lags),
            "least_speed_m_s": self.least_speed_m_s,
            **self.box.tables(),
            "layer": self.network.tables(),
        }


def read(keys: Mapping[str, Any], max_current_A: float, where: str) -> FeedForwardInverse:
    lags = lags_of(keys, "lags", 0, where)
    return FeedForwardInverse(
        box_of(keys, INPUTS, where),
        lags,
        number(keys, "sample_time_s", where),
        number(keys, "least_speed_m_s", where),
        max_current_A,
        network_of(keys.get("layer"), len(lags) * len(INPUTS), where),
    )


def make(
    source: Source,
    seed: int = 0,
    progress: Report = silent,
    settings: Settings | None = None,
) -> FeedForwardInverse:
    """UsageError where the current is the same throughout."""
    settings = settings or Settings()
    checked_levels(source)
    segments, most_A = source.segments, source.max_current_A
    time_s = settings.sample_time_s or sample_time_s(segments)
    least_m_s = LEAST_SPEED * largest_speed_m_s(segments)
    box = Box.of(segments, INPUTS)
    series = series_of(segments, box, settings.lags, time_s, source.part)
    inputs, targets = taught_rows(segments, series, time_s, least_m_s, settings.most_rows)
    rng = np.random.default_rng(seed)
    network, error = fitted(inputs, targets, settings.hidden, rng, settings.epochs, settings.decay)
    progress(f"{NAME}: {error * most_A:.3g} A root mean square on {len(inputs)} rows")
    return FeedForwardInverse(box, settings.lags, time_s, least_m_s, most_A, network)
