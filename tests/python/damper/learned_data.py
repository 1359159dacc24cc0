"""Synthetic tests of a damper for the learned models: a Kwok-like force with a lag."""

from collections.abc import Callable

import numpy as np
from quiesce.damper.data.record import Record
from quiesce.damper.data.split import Segment, whole
from quiesce.damper.learned.model import LearnedDamper
from quiesce.damper.library import Scales
from quiesce.damper.score import score

RATE_Hz = 500.0


def moved(
    disp_m: np.ndarray,
    velocity_m_s: np.ndarray,
    accel_m_s2: np.ndarray,
    current_A: np.ndarray | float,
    force: Callable[[np.ndarray, np.ndarray, np.ndarray], np.ndarray] | None = None,
    rate_Hz: float = RATE_Hz,
) -> Record:
    command = np.broadcast_to(np.asarray(current_A, float), disp_m.shape).copy()
    law = kwok_N if force is None else force
    return Record(
        name="synthetic",
        rate_Hz=rate_Hz,
        time_s=np.arange(len(disp_m)) / rate_Hz,
        disp_m=disp_m,
        velocity_m_s=velocity_m_s,
        accel_m_s2=accel_m_s2,
        force_N=law(disp_m, velocity_m_s, command),
        command=command,
        command_unit="A",
    )


def kwok_N(disp_m: np.ndarray, velocity_m_s: np.ndarray, current_A: np.ndarray) -> np.ndarray:
    """RD-1005-3, sgn(x) made smooth."""
    c = 1929.0 * current_A + 1232.0
    k = -1700.0 * current_A + 5100.0
    alpha = -244.0 * current_A**2 + 918.0 * current_A + 32.0
    delta = 0.3 * current_A + 0.58
    smooth = np.tanh(disp_m / 2e-4)
    return (
        c * velocity_m_s
        + k * disp_m
        + alpha * np.tanh(100.0 * velocity_m_s + delta * smooth)
        + 57.0
        - 18.0 * current_A
    )


def sine(
    freq_Hz: float, amplitude_m: float, current_A: float, cycles: float = 4.0, **more
) -> Record:
    rate_Hz = more.get("rate_Hz", RATE_Hz)
    time_s = np.arange(int(cycles / freq_Hz * rate_Hz) + 1) / rate_Hz
    omega = 2.0 * np.pi * freq_Hz
    return moved(
        amplitude_m * np.sin(omega * time_s),
        amplitude_m * omega * np.cos(omega * time_s),
        -amplitude_m * omega**2 * np.sin(omega * time_s),
        current_A,
        **more,
    )


def random_motion(seed: int, seconds: float = 6.0, current_A: float = 0.5, **more) -> Record:
    """A sum of sines of 0.5 .. 8 Hz, 5 mm or so."""
    rng = np.random.default_rng(seed)
    time_s = np.arange(int(seconds * RATE_Hz) + 1) / RATE_Hz
    disp, velocity, accel = (np.zeros_like(time_s) for _ in range(3))
    for freq_Hz in rng.uniform(0.5, 8.0, 8):
        omega, phase = 2.0 * np.pi * freq_Hz, rng.uniform(0.0, 2.0 * np.pi)
        size_m = 4e-3 / freq_Hz
        disp += size_m * np.sin(omega * time_s + phase)
        velocity += size_m * omega * np.cos(omega * time_s + phase)
        accel -= size_m * omega**2 * np.sin(omega * time_s + phase)
    return moved(disp, velocity, accel, current_A, **more)


def segments_of(*records: Record) -> tuple[list[Segment], Scales]:
    segments = [whole(one) for one in records]
    return segments, Scales.of(segments)


def backlash_N(disp_m: np.ndarray, velocity_m_s: np.ndarray, current_A: np.ndarray) -> np.ndarray:
    """A slider of 200 (1 + 2 i) N behind a spring of 1 mm travel, and 800 N s/m: has a memory."""
    out = np.empty_like(disp_m)
    stretch = 0.0
    previous = disp_m[0]
    for k, now in enumerate(disp_m):
        stretch = float(np.clip(stretch + now - previous, -1e-3, 1e-3))
        previous = now
        out[k] = 200.0 * (1.0 + 2.0 * current_A[k]) * stretch / 1e-3
    return out + 800.0 * velocity_m_s


def error_of(model: LearnedDamper, segments: list[Segment]) -> float:
    """||F - F_model|| / ||F||, free-running."""
    return score(model.simulate, segments).error
