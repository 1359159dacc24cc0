"""Tests of a damper that is known, to train its inverse on: random motions at currents in steps and
at currents that swing, as a rig would record them."""

import numpy as np

from quiesce.damper.data.record import Record
from quiesce.damper.data.split import Segment, whole
from quiesce.damper.excitation import random_motion, switched_current, times
from quiesce.damper.inverse import check_finite
from quiesce.damper.model_file import DamperModel
from quiesce.damper.score import Simulate

RATE_Hz = 500.0
DURATION_s = 15.0
TESTS = 4
LEVELS = 9
NOISE_PART = 0.01  # deviation of the force's noise over its RMS
STROKE_PART = 0.5
SPEED_PART = 0.8
MOTION_Hz = (0.4, 8.0)
CURRENT_Hz = (0.3, 5.0)


def moved(name: str, time_s: np.ndarray, disp_m: np.ndarray, command_A: np.ndarray) -> Record:
    """A record without force."""
    dt_s = time_s[1] - time_s[0]
    velocity = np.gradient(disp_m, dt_s, edge_order=2)
    accel = np.gradient(velocity, dt_s, edge_order=2)
    zero = np.zeros(len(time_s))
    return Record(name, 1.0 / dt_s, time_s, disp_m, velocity, accel, zero, command_A, "A")


def swinging_A(time_s: np.ndarray, most_A: float, seed: int) -> np.ndarray:
    swing = random_motion(time_s, 1.0, 1e9, CURRENT_Hz, seed)
    return most_A * np.clip(0.5 + 0.8 * swing, 0.0, 1.0)


def excited(
    damper: DamperModel, simulate: Simulate, most_A: float, seed: int, tests: int = TESTS
) -> list[Segment]:
    """`tests` recordings with measured force, every other with a current in steps. UsageError where
    the damper's force is not finite."""
    from dataclasses import replace

    rng = np.random.default_rng(seed)
    time_s = times(DURATION_s, RATE_Hz)
    amplitude_m, speed_m_s = STROKE_PART * damper.stroke_m, SPEED_PART * damper.speed_m_s
    levels = [float(level) for level in np.linspace(0.0, most_A, LEVELS)]
    out = []
    for k in range(tests):
        own = int(rng.integers(1 << 31))
        disp_m = random_motion(time_s, amplitude_m, speed_m_s, MOTION_Hz, own)
        is_stepped = k % 2 == 0
        command_A = (
            switched_current(time_s, levels, own + 1)
            if is_stepped
            else swinging_A(time_s, most_A, own + 1)
        )
        record = moved(f"random motion {k + 1}", time_s, disp_m, command_A)
        force_N = simulate(record)
        check_finite(damper, force_N)
        noise_N = (
            NOISE_PART * float(np.sqrt(np.mean(force_N**2))) * rng.standard_normal(len(record))
        )
        out.append(whole(replace(record, force_N=force_N + noise_N)))
    return out
