"""Feed-forward inverse network in the controller's integers: i = N(F, x, v at t and earlier).
Fitted as `ffn` is, in a size that a tick has time for.

Source: review of MR damper models, eq 38 (taps t and t-1); its text gives no sizes.
"""

from dataclasses import dataclass

import numpy as np

from quiesce.damper.inverses.demand import TICK_RATE_HZ, Source, checked_levels
from quiesce.damper.inverses.networks import READ_BY, NetworkInverse, inverse_of
from quiesce.damper.inverses.taps import (
    INPUTS,
    LEAST_SPEED,
    largest_speed_m_s,
    taught_rows,
)
from quiesce.damper.learned.inputs import Box
from quiesce.damper.learned.model import Report, silent
from quiesce.damper.learned.sampled import sample_time_s, series_of
from quiesce.law.forms.network import MOST_PAST
from quiesce.network.dense import fitted
from quiesce.network.integers import of_dense

NAME = "network"
TITLE = "feed-forward inverse network in integers (eq 38)"
HELP = "small feed-forward network that the controller itself works off"
TRACKER = READ_BY


@dataclass(frozen=True)
class Settings:
    hidden: tuple[int, ...] = (12, 8)
    is_delayed: bool = True  # also what was a sample before, where that is a few ticks
    most_rows: int = 12_000
    epochs: int = 80
    decay: float = 1e-3


def ticks_of(time_s: float) -> int:
    """0 where it is not a number of ticks that the controller keeps."""
    ticks = round(time_s * TICK_RATE_HZ)
    is_whole = abs(time_s * TICK_RATE_HZ - ticks) < 0.05
    return ticks if is_whole and 1 <= ticks <= MOST_PAST // len(INPUTS) else 0


def make(
    source: Source,
    seed: int = 0,
    progress: Report = silent,
    settings: Settings | None = None,
) -> NetworkInverse:
    """UsageError where the current is the same throughout."""
    settings = settings or Settings()
    checked_levels(source)
    segments, most_A = source.segments, source.max_current_A
    time_s = sample_time_s(segments)
    least_m_s = LEAST_SPEED * largest_speed_m_s(segments)
    box = Box.of(segments, INPUTS)
    delay_ticks = ticks_of(time_s) if settings.is_delayed else 0
    lags = (0, 1) if delay_ticks else (0,)
    series = series_of(segments, box, lags, time_s, source.part)
    inputs, targets = taught_rows(segments, series, time_s, least_m_s, settings.most_rows)
    rng = np.random.default_rng(seed)
    network, error = fitted(inputs, targets, settings.hidden, rng, settings.epochs, settings.decay)
    progress(f"{NAME}: {error * most_A:.3g} A root mean square on {len(inputs)} rows")
    return inverse_of(box, of_dense(network, 1e3 * most_A), most_A, least_m_s, delay_ticks)
