"""A three-storey frame with an MR damper in its lowest storey under earthquakes, and two laws for
it: clipped optimal control and a fuzzy one, both with the same knowledge of the state."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import tomli_w
from quiesce.base.paths import root
from quiesce.plant.library import Plant
from quiesce.plant.stepping import Run
from quiesce.plant.variant import read_plant_data
from scipy.linalg import expm, solve_continuous_are, solve_discrete_are

PLANT = "sim_hil/data/plants/frame_3dof.toml"
MAX_A = 2.0
TICK_RATE_HZ = 250
SECONDS = 8.0
# Of the observer's sensors, RMS in a sample.
ACCEL_NOISE_M_S2, STROKE_NOISE_M, FORCE_NOISE_N = 0.02, 2e-5, 0.02
GROUND_M_S2 = 0.8  # RMS of the ground's acceleration, as the observer takes it
# In place of the shipped linear damper: 0.3 N of friction without current, 9 N at 2 A.
DAMPER = {
    "model": "bingham",
    "stroke_m": 0.05,
    "speed_m_s": 1.0,
    "parameters": {
        "fc_N": [0.3, 4.5], "c_N_s_m": [5.0, 5.0], "f0_N": 0.0, "eps_m_s": 0.005,
    },
}  # fmt: skip

# State [6] (drifts to the ground, velocities), measured damper force: a current in A.
Law = Callable[[np.ndarray, float], float]


@dataclass(frozen=True)
class Frame:
    plant: Plant
    a: np.ndarray  # [6, 6] x' = a x + b F - base a_g
    b: np.ndarray  # [6] of the resisting force
    mass_kg: np.ndarray  # [3, 3]


def frame(folder: Path) -> Frame:
    data = read_plant_data(root() / PLANT)
    data["damper"] = DAMPER
    file = folder / "frame.toml"
    file.write_text(tomli_w.dumps(data), encoding="utf-8")
    of = data["structure"]
    mass, damping, stiffness = (
        np.array(of[key]) for key in ("mass_kg", "damping_N_s_m", "stiffness_N_m")
    )
    a = np.block(
        [
            [np.zeros((3, 3)), np.eye(3)],
            [-np.linalg.solve(mass, stiffness), -np.linalg.solve(mass, damping)],
        ]
    )
    b = np.concatenate([np.zeros(3), -np.linalg.solve(mass, np.array(of["damper"]))])
    return Frame(Plant(file), a, b, mass)


def earthquake(rng: np.random.Generator) -> np.ndarray:
    """Acceleration of the base at each tick: noise through Kanai and Tajimi's ground, of its own
    frequency (2 to 6 Hz) and damping, rising and dying away, with a peak of 1.5 to 3 m/s2."""
    count = int(SECONDS * TICK_RATE_HZ)
    time_s = np.arange(count) / TICK_RATE_HZ
    ground, damping = 2.0 * np.pi * rng.uniform(2.0, 6.0), rng.uniform(0.3, 0.6)
    s = 2j * np.pi * np.fft.rfftfreq(count, 1.0 / TICK_RATE_HZ)
    soil = (2 * damping * ground * s + ground**2) / (s**2 + 2 * damping * ground * s + ground**2)
    highpass = (s / (s + 2.0 * np.pi * 0.4)) ** 2
    wave = np.fft.irfft(np.fft.rfft(rng.standard_normal(count)) * soil * highpass, count)
    shape = np.minimum(time_s / 1.5, 1.0) * np.exp(-0.7 * np.maximum(time_s - 4.0, 0.0))
    wave *= shape
    return rng.uniform(1.5, 3.0) * wave / np.max(np.abs(wave))


class Observer:
    """Kalman filter of sampled signals: from the roof's absolute acceleration, the damper's stroke
    and its force to the state; the ground's acceleration is noise to it."""

    def __init__(self, of: Frame) -> None:
        self.c = np.stack([of.a[5], np.eye(6)[0]])
        self.d = np.array([of.b[5], 0.0])
        ground = np.concatenate([np.zeros(3), np.ones(3)])
        both = np.zeros((8, 8))
        both[:6] = np.column_stack([of.a, of.b, ground])
        whole = expm(both / TICK_RATE_HZ)
        self.step, self.by_force, by_ground = whole[:6, :6], whole[:6, 6], whole[:6, 7]
        noise = np.diag([ACCEL_NOISE_M_S2**2, STROKE_NOISE_M**2])
        process = GROUND_M_S2**2 * np.outer(by_ground, by_ground) + 1e-14 * np.eye(6)
        p = solve_discrete_are(self.step.T, self.c.T, process, noise)
        self.gain = p @ self.c.T @ np.linalg.inv(self.c @ p @ self.c.T + noise)
        self.ahead = np.zeros(6)

    def update(self, accel_m_s2: float, stroke_m: float, force_N: float) -> np.ndarray:
        """The state at these samples."""
        surprise = (accel_m_s2, stroke_m) - self.c @ self.ahead - self.d * force_N
        state = self.ahead + self.gain @ surprise
        self.ahead = self.step @ state + self.by_force * force_N
        return state


def clipped_optimal(of: Frame, drift: float, accel: float, effort: float) -> Law:
    """Full current where the damper's force has to grow towards the wanted one, -K x, and 0 where
    not (Dyke et al.; review of MR damper models, eq 27). Weights: of the drifts between storeys, of
    the roof's acceleration, and of the force, all as powers of ten."""
    between = np.hstack([np.array([[1.0, 0, 0], [-1.0, 1, 0], [0, -1.0, 1]]), np.zeros((3, 3))])
    roof = of.a[5]
    q = 10.0**drift * between.T @ between + 10.0**accel * np.outer(roof, roof) + 1e-9 * np.eye(6)
    r = np.array([[10.0**effort]])
    gain = (of.b[None, :] @ solve_continuous_are(of.a, of.b[:, None], q, r) / r)[0]

    def law(state: np.ndarray, force_N: float) -> float:
        wanted_N = -gain @ state
        return MAX_A if (wanted_N - force_N) * force_N > 0.0 else 0.0

    return law


def fuzzy(_of: Frame, storey: float, roof: float, top: float, opposed: float, still: float) -> Law:
    """Current from the velocities of the first storey and of the roof, each small or large (large:
    10 to the power of `storey` and of `roof` m/s): largest where both are large and of one sign,
    `opposed` of it where of opposite signs, `still` where both are small. Product and weighted
    mean; nine rules that are symmetric in sign."""
    scales = 10.0**storey, 10.0**roof
    centre = np.array([[top, 0.5 * top, opposed * top], [0.5 * top, still * top, 0.5 * top],
                       [opposed * top, 0.5 * top, top]])  # fmt: skip

    def grades(value: float, scale: float) -> np.ndarray:
        part = min(max(value / scale, -1.0), 1.0)
        return np.array([max(-part, 0.0), 1.0 - abs(part), max(part, 0.0)])

    def law(state: np.ndarray, _force_N: float) -> float:
        weights = np.outer(grades(state[3], scales[0]), grades(state[5], scales[1]))
        return min(max(float(np.sum(weights * centre)), 0.0), 1.0) * MAX_A

    return law


@dataclass(frozen=True)
class Response:
    peak_drift_m: float  # of the roof to the ground
    peak_accel_m_s2: float
    mean_A: float


def shaken(of: Frame, law: Law, base_m_s2: np.ndarray, rng: np.random.Generator) -> Response:
    """The observer sees roof acceleration, stroke and force with noise."""
    noise = rng.standard_normal((len(base_m_s2), 3)) * (
        ACCEL_NOISE_M_S2, STROKE_NOISE_M, FORCE_NOISE_N,
    )  # fmt: skip
    motion, observer = Run(of.plant, TICK_RATE_HZ), Observer(of)
    peak_m = peak_m_s2 = sum_A = 0.0
    for k, base in enumerate(base_m_s2):
        now = motion.now
        force_N = now.damper_force_N + noise[k, 2]
        state = observer.update(now.accel_m_s2 + noise[k, 0], now.stroke_m + noise[k, 1], force_N)
        motion.advance(law(state, force_N), base_accel_m_s2=base)
        peak_m = max(peak_m, abs(motion.now.disp_m))
        peak_m_s2 = max(peak_m_s2, abs(motion.now.accel_m_s2))
        sum_A += motion.now.coil_A
    return Response(peak_m, peak_m_s2, sum_A / len(base_m_s2))
