"""Feed-forward network over displacement, velocity and current, now and a few samples ago."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from quiesce.damper.data.split import Segment
from quiesce.damper.learned.inputs import Box, input_keys, stacked
from quiesce.damper.learned.model import LearnedDamper, Report, limits_of, silent
from quiesce.damper.learned.sampled import default_lags, sample_time_s, series_of
from quiesce.damper.library import Scales
from quiesce.network.dense import fitted


@dataclass(frozen=True)
class Settings:
    hidden: tuple[int, ...] = (24, 12)
    # In samples; () for a network without memory, None for 0, 1, 2, 4, ... up to 30 ms.
    lags: tuple[int, ...] | None = None
    sample_time_s: float | None = None  # None: that of the data
    epochs: int = 60
    decay: float = 1e-2


# Of --effort quick, and what stands where time runs out.
BRIEF = Settings(epochs=15)


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
    lags = default_lags(time_s) if settings.lags is None else settings.lags
    box = Box.of(segments, input_keys(segments) if not lags else input_keys(segments)[:3])
    if lags:
        series = series_of(segments, box, lags, time_s, lambda one: one.force_N / scales.force_N)
        inputs = np.concatenate([one.inputs[one.first :] for one in series])
        force = np.concatenate([one.target[one.first :] for one in series])
    else:
        inputs, force_N = stacked(segments, box)
        force = force_N / scales.force_N
    network, error = fitted(inputs, force, settings.hidden, rng, settings.epochs, settings.decay)
    progress(f"feed_forward_network: error {error:.4g} of the largest force")
    delays = {"lags": list(lags), "sample_time_s": float(time_s)} if lags else {}
    parameters = {
        "force_scale_N": float(scales.force_N),
        **delays,
        **box.tables(),
        "layer": network.tables(),
    }
    return LearnedDamper(
        "feed_forward_network",
        **limits_of(scales),
        parameters=parameters,
        parameter_count=network.parameter_count,
        notes=(f"{inputs.shape[1]} inputs, hidden layers of {list(settings.hidden)}",),
    )
