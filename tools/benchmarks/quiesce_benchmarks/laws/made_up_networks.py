"""Networks with weights of chance: what one costs depends on its size alone."""

import numpy as np
from quiesce.law.forms.network import (
    DEMAND,
    NetworkSection,
    NetworkTable,
    NetworkTrackTable,
    Span,
)
from quiesce.law.signal import Signal, signal
from quiesce.network.dense import Network
from quiesce.network.integers import of_dense
from quiesce.network.layers import Layers

HIDDEN = 12
SPANS = (
    Span.of(signal("stroke", 0), -0.03, 0.03),
    Span.of(signal("stroke velocity", 0), -0.5, 0.5),
)
FORCE = Span.of(signal("force", 0), -1500.0, 1500.0)
LARGEST_mA, USUAL_mA, LEAST_um_s = 2500, 700.0, 20_000
DELAY_ticks, RATE_Hz = 2, 1000


def layers(inputs: int, seed: int) -> Layers:
    network = Network.random((inputs, HIDDEN, 1), np.random.default_rng(seed))
    network.biases[-1][:] = 1.5
    return of_dense(network, USUAL_mA)


def law_words() -> list[int]:
    """Of law `network`: a current from stroke, its velocity and the force."""
    return NetworkTable((NetworkSection((*SPANS, FORCE), 0, LARGEST_mA, layers(3, 4)),)).words()


def tracker_words() -> list[int]:
    """Of tracker `network`: from the demand, stroke and its velocity, now and two ticks before."""
    spans = (Span.of(Signal(DEMAND, 0), -1500.0, 1500.0), *SPANS)
    section = NetworkSection(spans, DELAY_ticks, LARGEST_mA, layers(6, 8), LEAST_um_s, RATE_Hz)
    return NetworkTrackTable((section,)).words()
