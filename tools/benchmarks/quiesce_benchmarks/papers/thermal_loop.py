"""A mass on springs with an MR damper that warms up, and a force tracker on it: the plant, the test
rig that the tracker's model learns from, and the closed loop."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import tomli_w
from quiesce.base.paths import root
from quiesce.damper.data.record import Record
from quiesce.damper.data.split import Segment
from quiesce.damper.inverse import forces_at
from quiesce.damper.inverses.support_vector import InverseSupportVector
from quiesce.damper.learned.temperature import ThermalFactors
from quiesce.damper.library import values_at
from quiesce.damper.model_file import DamperModel, read_model
from quiesce.plant.library import Plant
from quiesce.plant.stepping import Now, Run
from quiesce.plant.variant import read_plant_data

PLANT = "sim_hil/data/plants/suspended_mass.toml"
DAMPER = "sim_hil/data/dampers/rd1005_kwok_tanh_smooth.toml"
MAX_A = 1.8
COLD_C = 20.0
FACTORS = ThermalFactors(reference_C=25.0)
CONDUCTANCE_W_K = 0.4
COIL_OHM = 5.0
TICK_RATE_HZ = 500
"""Of a tracker's sensors, RMS in a sample."""
STROKE_NOISE_M, SPEED_NOISE_M_S, FLUID_NOISE_K = 2e-5, 2e-3, 0.5
WANTED_N_S_M = 5000.0  # the tracker is to make a linear damper of it


def write_plant(folder: Path, heat_capacity_J_K: float) -> Plant:
    """The shipped plant; its damper warms up, with the factors that test rigs see (rig_records)."""
    data = read_plant_data(root() / PLANT)
    data["damper"]["thermal"] = {
        "heat_capacity_J_K": heat_capacity_J_K,
        "conductance_W_K": CONDUCTANCE_W_K,
        "ambient_C": COLD_C,
        "coil_ohm": COIL_OHM,
        "activation_K": FACTORS.activation_K,
        "yield_1_K": FACTORS.yield_1_K,
        "reference_C": FACTORS.reference_C,
    }
    file = folder / "warm_suspended_mass.toml"
    file.write_text(tomli_w.dumps(data), encoding="utf-8")
    return Plant(file)


def forces_N(
    damper: DamperModel, record: Record, currents_A: list[float], temperature_C: np.ndarray
) -> np.ndarray:
    """[currents, samples] of the damper at these temperatures: its viscous part c v and what
    neither spring nor offset makes take the factors of the plant's [thermal]."""
    one, orders, row = damper.kernel_row()
    names = [parameter.name for parameter in one.parameters]
    out = []
    whole_N = forces_at(damper, record, currents_A)
    for current_A, force_N in zip(currents_A, whole_N, strict=True):
        value = dict(zip(names, values_at(one, orders, row, current_A), strict=True))
        viscous_N = value["c_N_s_m"] * record.velocity_m_s
        other_N = value["k_N_m"] * record.disp_m + value["f0_N"]
        yield_N = force_N - viscous_N - other_N
        out.append(
            viscous_N * FACTORS.viscous(temperature_C)
            + yield_N * FACTORS.yielding(temperature_C)
            + other_N
        )
    return np.array(out)


def rig_records(rng: np.random.Generator, temperatures_C: list[float]) -> list[Record]:
    """Tests of the damper in a climate chamber, slow enough to keep its temperature: sines at
    constant currents, with 1 % of noise in the force and 0.5 K in the temperature."""
    damper = read_model(root() / DAMPER)
    currents_A = [0.0, 0.3, 0.6, 0.9, 1.3, MAX_A]
    out = []
    for freq_Hz, amplitude_m in ((1.0, 0.02), (2.0, 0.006), (2.0, 0.02), (4.0, 0.01)):
        time_s = np.arange(0.0, 1.0 / freq_Hz, 0.005)
        w = 2.0 * np.pi * freq_Hz
        x_m, v_m_s = amplitude_m * np.sin(w * time_s), amplitude_m * w * np.cos(w * time_s)
        still = np.zeros(len(time_s))
        bare = Record("rig", 200.0, time_s, x_m, v_m_s, -(w**2) * x_m, still, still, "A")
        for warm_C in temperatures_C:
            warm = np.full(len(time_s), warm_C)
            whole_N = forces_N(damper, bare, currents_A, warm)
            for current_A, force_N in zip(currents_A, whole_N, strict=True):
                noise_N = 0.01 * np.abs(whole_N).max() * rng.standard_normal(len(time_s))
                out.append(
                    replace(
                        bare,
                        force_N=force_N + noise_N,
                        command=np.full(len(time_s), current_A),
                        temperature_C=warm + FLUID_NOISE_K * rng.standard_normal(len(time_s)),
                    )
                )
    return out


def whole(records: list[Record]) -> list[Segment]:
    return [Segment(record, 0, len(record)) for record in records]


def road(rng: np.random.Generator, seconds: float, rms_m_s2: float = 1.2) -> np.ndarray:
    """Acceleration of the base at each tick: Gaussian, 2 to 4 Hz."""
    count = int(seconds * TICK_RATE_HZ)
    freqs_Hz = np.fft.rfftfreq(count, 1.0 / TICK_RATE_HZ)
    spectrum = rng.standard_normal(len(freqs_Hz)) + 1j * rng.standard_normal(len(freqs_Hz))
    spectrum[(freqs_Hz < 2.0) | (freqs_Hz > 4.0)] = 0.0
    wave = np.fft.irfft(spectrum, count)
    return rms_m_s2 * wave / np.sqrt(np.mean(wave**2))


@dataclass(frozen=True)
class Loop:
    """What happened at each tick, true values; the wanted force is what the law asked for."""

    stroke_m: np.ndarray
    velocity_m_s: np.ndarray
    accel_m_s2: np.ndarray
    force_N: np.ndarray
    wanted_N: np.ndarray
    coil_A: np.ndarray
    fluid_C: np.ndarray


# Current from the wanted force, what was measured of stroke, velocity and temperature, and the
# current before.
Tracker = Callable[[float, float, float, float, float], float]


def tracker_of(model: InverseSupportVector) -> Tracker:
    return model.current_A


def run(plant: Plant, base_m_s2: np.ndarray, tracker: Tracker, rng: np.random.Generator) -> Loop:
    """The law asks for the force of a linear damper, the tracker makes a current of it."""
    noise = rng.standard_normal((len(base_m_s2), 3)) * (
        STROKE_NOISE_M, SPEED_NOISE_M_S, FLUID_NOISE_K,
    )  # fmt: skip
    motion = Run(plant, TICK_RATE_HZ)
    rows = np.empty((len(base_m_s2), 7))
    held_A = 0.0
    for k, base in enumerate(base_m_s2):
        now: Now = motion.now
        seen = noise[k] + (now.stroke_m, now.stroke_velocity_m_s, now.fluid_C)
        wanted_N = WANTED_N_S_M * seen[1]
        rows[k] = (
            now.stroke_m, now.stroke_velocity_m_s, now.accel_m_s2, now.damper_force_N, wanted_N,
            now.coil_A, now.fluid_C,
        )  # fmt: skip
        held_A = tracker(wanted_N, seen[0], seen[1], seen[2], held_A)
        motion.advance(held_A, base_accel_m_s2=base)
    return Loop(*rows.T)


def feasible_N(loop: Loop) -> np.ndarray:
    """The wanted force as far as the damper could have given it: between its forces at 0 and at
    MAX_A, at the stroke, velocity and temperature that it had."""
    still = np.zeros(len(loop.stroke_m))
    time_s = np.arange(len(still)) / TICK_RATE_HZ
    record = Record(
        "loop", TICK_RATE_HZ, time_s, loop.stroke_m, loop.velocity_m_s, still, still, still, "A"
    )
    damper = read_model(root() / DAMPER)
    ends = forces_N(damper, record, [0.0, MAX_A], loop.fluid_C)
    return np.clip(loop.wanted_N, ends.min(axis=0), ends.max(axis=0))


def error_of(loop: Loop, rows: slice = slice(None)) -> float:
    """RMS of the force's error over RMS of the feasible force."""
    feasible = feasible_N(loop)
    error = (loop.force_N - feasible)[rows]
    return float(np.sqrt(np.mean(error**2) / np.mean(feasible[rows] ** 2)))
