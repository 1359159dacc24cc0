"""Structures and dampers drawn at random within stated ranges, and what their engineer knows of
them before he begins."""

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import tomli_w
from quiesce.plant.library import Plant

# Drawn evenly in the logarithm.
FREQ_Hz, MASS_kg = (2.0, 30.0), (5.0, 300.0)
DAMPING = (0.01, 0.04)
# Of the excitation: its acceleration at resonance without a damper, RMS and amplitude alike.
ACCEL_m_s2 = (1.0, 3.0)
FORCE_PART = (0.4, 1.2)  # of the damper at full current, of the shaker's
SECOND_MODE = (4.0, 7.0)  # times the first
LAG_s = (0.002, 0.008)
FULL_A = (1.0, 5.0)
# By how much the engineer's data sheets are off: gap, viscosity, lag; accelerometer's scale.
OFF_GAP, OFF_VISCOSITY, OFF_LAG, OFF_SCALE = 0.1, 0.3, 0.5, 0.05
GAP_PART = 4.0  # of the amplitude at resonance
YIELD_PART = 0.02  # of the velocity there: where the film yields
RADIUS_m, VISCOSITY_Pa_s, TURNS, COIL_RADIUS_m, YIELD_Pa = 0.025, 0.042, 1000, 0.03, 4000.0
G_m_s2 = 9.80665
RANGES_g = (2.0, 4.0, 8.0)


@dataclass(frozen=True)
class Drawn:
    """plant: the truth. base: what is known of sensor, driver, damper. damper: a file, where the
    damper was identified by itself."""

    plant: Path
    base: Path
    damper: Path | None
    mass_kg: float
    freq_Hz: float
    start: tuple[str, ...]  # settings of its controller


def draw(seed: int, number: int, folder: Path) -> Drawn:
    """The structure of that number. Every third one has a damper that was identified by itself, a
    Bingham one; the others a squeeze film that is found in place."""
    rng = np.random.default_rng([seed, number])
    mass_kg, freq_Hz = logarithmic(rng, MASS_kg), logarithmic(rng, FREQ_Hz)
    damping, accel_m_s2 = rng.uniform(*DAMPING), logarithmic(rng, ACCEL_m_s2)
    omega = 2.0 * math.pi * freq_Hz
    amp_m = accel_m_s2 / omega**2
    force_N = 2.0 * damping * mass_kg * accel_m_s2
    full_A = float(f"{rng.uniform(*FULL_A):.2g}")
    lag_s = float(f"{rng.uniform(*LAG_s):.2g}")
    damper_N = force_N * rng.uniform(*FORCE_PART)
    truth = {
        "schema": "quiesce-plant",
        "version": 1,
        "name": f"drawn_{seed}_{number}",
        "structure": structure(rng, mass_kg, freq_Hz, damping),
        "driver": {"max_current_A": full_A, "bits": 12},
        "coil": {"rise_s": lag_s},
        "shaker": {"gain_N_V": force_N, "ref_freq_Hz": freq_Hz, "drive_V": 1.0},
        "sensor": sensor(rng, accel_m_s2),
    }
    folder.mkdir(parents=True, exist_ok=True)
    damper = None
    if number % 3 == 2:
        damper = folder / "own_damper.toml"
        damper.write_text(tomli_w.dumps(bingham(damper_N, full_A, amp_m, omega)))
        truth["damper"] = {"file": damper.name}
    else:
        truth["damper"] = film(damper_N, full_A, amp_m, omega)
    plant = written(folder / "truth.toml", truth)
    base = written(folder / "data_sheets.toml", known(rng, truth))
    scale_nm_s2 = (
        1e9 * G_m_s2 * truth["sensor"]["full_scale_g"] / 2 ** (truth["sensor"]["bits"] - 1)
    )
    off = round(scale_nm_s2 * (1.0 + rng.uniform(-OFF_SCALE, OFF_SCALE)))
    start = (f"accel_scale_nm_s2={off}", f"accel_polarity={int(rng.choice([-1, 1]))}")
    return Drawn(plant, base, damper, mass_kg, freq_Hz, start)


def logarithmic(rng: np.random.Generator, ends: tuple[float, float]) -> float:
    return float(f"{math.exp(rng.uniform(math.log(ends[0]), math.log(ends[1]))):.4g}")


def structure(
    rng: np.random.Generator, mass_kg: float, freq_Hz: float, damping: float
) -> dict[str, Any]:
    """Two modes. Shaker, damper and sensor at one place in the first; the second, which has that
    place and another one, is felt less."""
    first, second = 1.0 / math.sqrt(mass_kg), float(rng.uniform(0.3, 0.7))
    return {
        "kind": "modes",
        "mode": [
            mode(freq_Hz, damping, first, first),
            mode(freq_Hz * rng.uniform(*SECOND_MODE), damping, -second * first, second * first),
        ],
    }


def mode(freq_Hz: float, damping: float, at_force: float, at_sensor: float) -> dict[str, float]:
    return {
        "freq_Hz": float(freq_Hz),
        "damping_ratio": float(damping),
        "at_force": at_force,
        "at_damper": at_sensor,
        "at_sensor": at_sensor,
    }


def sensor(rng: np.random.Generator, accel_m_s2: float) -> dict[str, Any]:
    """With an offset that nobody knows."""
    range_g = next(one for one in RANGES_g if one * G_m_s2 > 2.0 * accel_m_s2 + G_m_s2)
    return {
        "full_scale_g": range_g,
        "bits": 20,
        "noise_mg": 0.1,
        "offset_counts": int(rng.integers(-3000, 3000)),
    }


def film(force_N: float, full_A: float, amp_m: float, omega: float) -> dict[str, Any]:
    """A squeeze film: so much force beyond yield at full current (Bingham limit, plant_file.py)."""
    gap_m = GAP_PART * amp_m
    field = TURNS * full_A / (2.0 * math.pi * COIL_RADIUS_m)
    plates = 2.0 * math.pi * RADIUS_m**3 / (3.0 * gap_m) * YIELD_Pa
    yields_m_s = YIELD_PART * amp_m * omega
    return {
        "model": "squeeze_biviscosity",
        "plate_radius_m": RADIUS_m,
        "gap_m": gap_m,
        "viscosity_Pa_s": VISCOSITY_Pa_s,
        "viscosity_ratio": yields_m_s * 3.0 * VISCOSITY_Pa_s * RADIUS_m / (gap_m**2 * YIELD_Pa),
        "yield_coefficient": YIELD_Pa / field,
        "yield_exponent": 1.0,
        "coil_turns": TURNS,
        "coil_radius_m": COIL_RADIUS_m,
        "force_scale": force_N / plates,
    }


def bingham(force_N: float, full_A: float, amp_m: float, omega: float) -> dict[str, Any]:
    """As 'quiesce identify' writes one."""
    return {
        "schema": "quiesce-damper",
        "version": 1,
        "name": "own_damper",
        "model": "bingham",
        "stroke_m": 20.0 * amp_m,
        "speed_m_s": 20.0 * amp_m * omega,
        "parameters": {
            "fc_N": [0.02 * force_N, force_N / full_A],
            "c_N_s_m": [0.02 * force_N / (amp_m * omega), 0.0],
            "f0_N": 0.0,
            "eps_m_s": YIELD_PART * amp_m * omega,
        },
        "valid": {"current_A": [0.0, full_A]},
    }


def known(rng: np.random.Generator, truth: dict[str, Any]) -> dict[str, Any]:
    """Of data sheets: another structure, and a film that is not quite the true one."""
    damper = dict(truth["damper"])
    if "gap_m" in damper:
        damper["gap_m"] *= 1.0 + rng.uniform(-OFF_GAP, OFF_GAP)
        damper["viscosity_Pa_s"] *= 1.0 + rng.uniform(-OFF_VISCOSITY, OFF_VISCOSITY)
    lag_s = truth["coil"]["rise_s"] * (1.0 + rng.uniform(-OFF_LAG, OFF_LAG))
    modes = {"kind": "modes", "mode": [mode(10.0, 0.02, 1.0, 1.0)]}
    return {**truth, "name": "data_sheets", "structure": modes, "damper": damper,
            "coil": {"rise_s": lag_s}}  # fmt: skip


def written(file: Path, data: dict[str, Any]) -> Path:
    """With steps of the integration that it can go with."""
    file.write_text(tomli_w.dumps({**data, "integration": {"max_step_us": 1.0}}))
    step_us = min(500.0, 0.8e6 * Plant(file).safe_step_s)
    file.write_text(tomli_w.dumps({**data, "integration": {"max_step_us": step_us}}))
    Plant(file)
    return file
