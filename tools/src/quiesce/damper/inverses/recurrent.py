"""Recurrent inverse network: its own earlier currents are among its inputs, so that it goes on by
itself where the force does not tell the current.

    i(t) = N(i at t-1, t-2, ..; F, x, v at t and earlier)

Source: review of MR damper models, eq 37, whose inputs are Ov + IF + Ix (the review counts IF + Ix
only) and which has no velocity; with it fewer taps of x are needed. Trained with the measured
currents fed back, then with its own (gradients through time), as the forward network is.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from quiesce.damper.data.record import Record
from quiesce.damper.inverses.demand import Source, checked_levels
from quiesce.damper.inverses.keys import box_of, lags_of, network_of, number
from quiesce.damper.inverses.taps import INPUTS, spread
from quiesce.damper.learned import recurrent
from quiesce.damper.learned.inputs import Box
from quiesce.damper.learned.model import Report, named, silent
from quiesce.damper.learned.sampled import delayed, sample_time_s, sampled_rows, series_of
from quiesce.network.dense import Network

NAME = "rnn"
TITLE = "recurrent inverse network (eq 37)"
HELP = "recurrent network over the same and its own earlier currents"
TRACKER = (
    "has a memory: no table holds it; the firmware has no tracker with delayed inputs, weights and "
    "tanh layers"
)
LIMITS = (0.0, 1.0)  # of currents fed back, in parts of the largest
# Much noise on the currents fed back in training: else the network learns to repeat the one before,
# which tells nothing once it runs free.
SETTINGS = recurrent.Settings(
    hidden=(24,), feedback=(1, 2), lags=(0, 1, 2, 4), epochs=40, free_steps=100, noise=0.3
)


@dataclass(frozen=True)
class RecurrentInverse:
    """Inputs are cut off at the range of the training, currents fed back at 0 and the largest."""

    box: Box
    lags: tuple[int, ...]
    feedback: tuple[int, ...]
    sample_time_s: float
    max_current_A: float
    network: Network

    def currents(self, demand: Record) -> np.ndarray:
        rows = sampled_rows(demand, self.sample_time_s)
        inputs = delayed(self.box.picked(demand)[rows], self.box, self.lags)
        parts = recurrent.free_run(self.network, inputs, self.feedback, LIMITS)
        return spread(self.max_current_A * parts, rows, len(demand))

    def parameters(self) -> dict[str, Any]:
        return {
            "sample_time_s": self.sample_time_s,
            "lags": list(self.lags),
            "feedback": list(self.feedback),
            **self.box.tables(),
            "layer": self.network.tables(),
        }


def read(keys: Mapping[str, Any], max_current_A: float, where: str) -> RecurrentInverse:
    lags = lags_of(keys, "lags", 0, where)
    feedback = lags_of(keys, "feedback", 1, where)
    inputs = len(lags) * len(INPUTS) + len(feedback)
    return RecurrentInverse(
        box_of(keys, INPUTS, where),
        lags,
        feedback,
        number(keys, "sample_time_s", where),
        max_current_A,
        network_of(keys.get("layer"), inputs, where),
    )


def make(
    source: Source,
    seed: int = 0,
    progress: Report = silent,
    settings: recurrent.Settings | None = None,
) -> RecurrentInverse:
    """UsageError where the current is the same throughout."""
    settings = settings or SETTINGS
    checked_levels(source)
    segments = source.segments
    time_s = settings.sample_time_s or sample_time_s(segments)
    box = Box.of(segments, INPUTS)
    lags = settings.lags or (0,)
    series = series_of(segments, box, lags, time_s, source.part)
    report, rng = named(NAME, progress), np.random.default_rng(seed)
    found = recurrent.learned(series, settings, rng, report, LIMITS)
    error_A = found.error * source.max_current_A
    report(f"{error_A:.3g} A root mean square, running free")
    return RecurrentInverse(
        box, lags, settings.feedback, time_s, source.max_current_A, found.network
    )
