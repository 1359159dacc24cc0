"""Network over envelope, instantaneous frequency and phase of the displacement beside displacement,
velocity and current, all of them now and a few samples ago.

Source: review of MR damper models, eq 34. Published, the three are those of the analytic signal,
whose Hilbert transform needs the whole record, the future included (`published`). A damper file and
a plant have the causal form only (`Quadrature.features`; quiesce_quadrature in
sim_hil/damper/learned/cores/sampled_network_core.h). The phase p is given as cos p and sin p: p
itself jumps.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.signal import hilbert

from quiesce.damper.data.record import Record
from quiesce.damper.data.split import Segment
from quiesce.damper.learned.inputs import MOST_ROWS, Box
from quiesce.damper.learned.model import LearnedDamper, Report, limits_of, silent
from quiesce.damper.learned.sampled import delayed, sample_time_s, sampled_rows
from quiesce.damper.library import Scales
from quiesce.network.dense import Network
from quiesce.network.dense import fitted as fitted_network

FEATURES = 4  # envelope, frequency, cos p, sin p
_REST = 1e-3  # of the largest envelope: less is rest
_SPREAD = 4.0  # of the frequency, up and down from its mean
_LEAST_MEAN = 1e-300

# Displacements and velocities at the sample time -> features [samples, FEATURES].
Features = Callable[[np.ndarray, np.ndarray], np.ndarray]


@dataclass(frozen=True)
class Settings:
    hidden: tuple[int, ...] = (24, 12)
    lags: tuple[int, ...] = (0, 1, 2, 4)  # in samples
    sample_time_s: float | None = None  # None: that of the data
    periods: float = 0.3  # of the mean frequency: window of the causal form
    epochs: int = 60
    decay: float = 1e-3


# Of --effort quick, and what stands where time runs out.
BRIEF = Settings(epochs=15)


@dataclass(frozen=True)
class Quadrature:
    window_s: float
    envelope_m: float
    lowest_rad_s: float
    highest_rad_s: float
    sample_time_s: float

    @staticmethod
    def of(segments: Sequence[Segment], scales: Scales, time_s: float, periods: float):
        """Frequencies about the mean one, sqrt(mean(v^2) / mean(x^2))."""
        disp = np.concatenate([one.record.disp_m[one.rows] for one in segments])
        velocity = np.concatenate([one.record.velocity_m_s[one.rows] for one in segments])
        mean_rad_s = float(np.sqrt(np.mean(velocity**2) / max(np.mean(disp**2), _LEAST_MEAN)))
        mean_rad_s = min(max(mean_rad_s, 1e-3), 1e5)
        return Quadrature(
            2.0 * np.pi * periods / mean_rad_s,
            1.5 * scales.disp_m,
            mean_rad_s / _SPREAD,
            mean_rad_s * _SPREAD,
            time_s,
        )

    def scaled(self, envelope_m: np.ndarray, rad_s: np.ndarray, phase: np.ndarray) -> np.ndarray:
        """Features; 0 at rest."""
        low, high = self.lowest_rad_s, self.highest_rad_s
        columns = [
            2.0 * np.clip(envelope_m / self.envelope_m, 0.0, 1.0) - 1.0,
            2.0 * (np.clip(rad_s, low, high) - low) / (high - low) - 1.0,
            np.cos(phase),
            np.sin(phase),
        ]
        moves = envelope_m >= _REST * self.envelope_m
        return np.where(moves[:, None], np.stack(columns, axis=1), 0.0)

    def features(self, disp_m: np.ndarray, velocity_m_s: np.ndarray) -> np.ndarray:
        """Causal: H[x] = -v / w, w from running means over the window."""
        part = self.sample_time_s / (self.window_s + self.sample_time_s)
        means = np.empty((len(disp_m), 2))
        mean = np.zeros(2)
        for k, square in enumerate(np.stack([disp_m**2, velocity_m_s**2], axis=1)):
            mean = mean + part * (square - mean)
            means[k] = mean
        rest_m = _REST * self.envelope_m
        rad_s = np.sqrt(means[:, 1] / np.maximum(means[:, 0], rest_m**2))
        rad_s = np.clip(rad_s, self.lowest_rad_s, self.highest_rad_s)
        quadrature_m = -velocity_m_s / rad_s
        return self.scaled(np.hypot(disp_m, quadrature_m), rad_s, np.arctan2(quadrature_m, disp_m))

    def published(self, disp_m: np.ndarray, velocity_m_s: np.ndarray) -> np.ndarray:
        """Not causal: the analytic signal of the whole record by FFT. The velocity is not used."""
        analytic = hilbert(disp_m)
        phase = np.unwrap(np.angle(analytic))
        rad_s = np.gradient(phase, self.sample_time_s)
        return self.scaled(np.abs(analytic), rad_s, phase)

    def table(self) -> dict[str, float]:
        names = ("window_s", "envelope_m", "lowest_rad_s", "highest_rad_s")
        return {name: float(getattr(self, name)) for name in names}


def taps(
    record: Record, rows: np.ndarray, box: Box, lags: Sequence[int], features: Features | None
) -> np.ndarray:
    """Inputs and, behind them, features of every lag, [rows, lags * (inputs + features)]; rest
    before the first."""
    plain = delayed(box.picked(record)[rows], box, lags)
    if features is None:
        return plain
    found = features(record.disp_m[rows], record.velocity_m_s[rows])
    padded = np.concatenate([np.zeros((max(lags), FEATURES)), found])
    late = [padded[max(lags) - lag : max(lags) - lag + len(rows)] for lag in lags]
    parts = np.split(plain, len(lags), axis=1)
    pairs = zip(parts, late, strict=True)
    return np.concatenate([one for pair in pairs for one in pair], axis=1)


@dataclass(frozen=True)
class TapNetwork:
    """In numpy, for any features; at every sample of records at the sample time."""

    box: Box
    lags: tuple[int, ...]
    sample_time_s: float
    force_scale_N: float
    features: Features | None
    network: Network
    error: float  # root mean square in training, of the largest force

    def simulate(self, record: Record) -> np.ndarray:
        rows = sampled_rows(record, self.sample_time_s)
        inputs = taps(record, rows, self.box, self.lags, self.features)
        at_rows = self.force_scale_N * self.network(inputs)[:, 0]
        return at_rows[np.searchsorted(rows, np.arange(len(record)), side="right") - 1]


def fitted(
    segments: Sequence[Segment],
    scales: Scales,
    seed: int,
    settings: Settings,
    time_s: float,
    features: Features | None,
) -> TapNetwork:
    box = Box.of(segments)
    inputs, force = [], []
    for one in segments:
        rows = sampled_rows(one.record, time_s)
        rows = rows[rows < one.end]
        first = int(np.searchsorted(rows, one.first))
        inputs.append(taps(one.record, rows, box, settings.lags, features)[first:])
        force.append(one.record.force_N[rows][first:] / scales.force_N)
    u, y = np.concatenate(inputs), np.concatenate(force)
    every = max(1, int(np.ceil(len(u) / MOST_ROWS)))
    u, y = u[::every], y[::every]
    rng = np.random.default_rng(seed)
    network, error = fitted_network(u, y, settings.hidden, rng, settings.epochs, settings.decay)
    return TapNetwork(box, settings.lags, time_s, scales.force_N, features, network, error)


def train(
    segments: Sequence[Segment],
    scales: Scales,
    seed: int = 0,
    settings: Settings | None = None,
    progress: Report = silent,
) -> LearnedDamper:
    """The causal form."""
    settings = settings or Settings()
    time_s = settings.sample_time_s or sample_time_s(segments)
    quadrature = Quadrature.of(segments, scales, time_s, settings.periods)
    found = fitted(segments, scales, seed, settings, time_s, quadrature.features)
    progress(f"hilbert_network: error {found.error:.4g} of the largest force")
    parameters = {
        "force_scale_N": float(scales.force_N),
        "lags": list(settings.lags),
        "sample_time_s": float(time_s),
        "quadrature": quadrature.table(),
        **found.box.tables(),
        "layer": found.network.tables(),
    }
    return LearnedDamper(
        "hilbert_network",
        **limits_of(scales),
        parameters=parameters,
        parameter_count=found.network.parameter_count,
        notes=(
            f"envelope, frequency and phase over {quadrature.window_s:.3g} s, causal; "
            f"{len(settings.lags)} taps",
        ),
    )
