"""The squeeze-mode paper's rig for its damper (II.A, II.B, III.B), on films that are known.

A shaker moves the upper disc by a sine, an eddy-current sensor (Table II) measures it, a load cell
under the vessel the force, an analyser records both. The film is the plant's own damper class.
"""

import tomllib
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from quiesce.base.paths import default_plant
from quiesce.damper.data.condition import Settings, condition
from quiesce.damper.data.read import RawTest
from quiesce.damper.data.record import Record
from quiesce.damper.library import motion
from quiesce.damper.model_file import DamperModel, opened
from quiesce.damper.simulate import simulator_of_file

from quiesce_benchmarks.seeds import generator

# (amplitude in m, frequency in Hz): the first is fitted, the others judge.
CELLS = ((5e-5, 5.0), (5e-5, 10.0), (1e-4, 5.0), (1e-4, 10.0))
CURRENTS_A = (0.0, 1.0, 2.0, 3.0)
# Table V, biviscosity: RMSE in N by current, then cell.
PUBLISHED_N = (
    (0.0469, 0.0766, 0.0754, 0.0475),
    (0.0543, 0.0804, 0.1057, 0.0808),
    (0.0737, 0.0680, 0.0887, 0.0838),
    (0.0674, 0.0827, 0.0873, 0.1072),
)


@dataclass(frozen=True)
class BoucWenRow:
    """A row of Table III that we need: damping, stiffness, RMSE; x in mm and F in N."""

    damping_N_s_mm: float
    stiffness_N_mm: float
    rmse_N: float

    def rms_N(self, amplitude_m: float, freq_Hz: float) -> tuple[float, float]:
        """Of the elastic and of the viscous part over a sine; in quadrature to each other."""
        amplitude_mm = 1e3 * amplitude_m
        speed_mm_s = 2.0 * np.pi * freq_Hz * amplitude_mm
        elastic_N = self.stiffness_N_mm * amplitude_mm / np.sqrt(2.0)
        return float(elastic_N), float(self.damping_N_s_mm * speed_mm_s / np.sqrt(2.0))


TABLE_III = (
    BoucWenRow(0.124, 3.1, 0.050),
    BoucWenRow(0.170, 3.399, 0.065),
    BoucWenRow(0.237, 3.403, 0.054),
    BoucWenRow(0.271, 4.092, 0.115),
)


@dataclass(frozen=True)
class Sensors:
    """Table II: a resolution of 0.1 % of 5 mm, 3.3 kHz. The paper names no load cell: the same
    0.1 %, of 10 N, is assumed; its best RMSE, 0.047 N, bounds its own noise. The analyser: 100 Hz
    span, records of 1024 samples."""

    disp_noise_m: float = 5e-6 / np.sqrt(12.0)  # deviation of what a step of 5 um leaves
    disp_corner_Hz: float = 3300.0
    force_noise_N: float = 0.01
    rate_Hz: float = 256.0
    samples: int = 4 * 1024
    low_pass_Hz: float = 25.0  # of the displacement, before it is differentiated


@dataclass(frozen=True)
class Film:
    """A damper that is known: keys of the model squeeze_biviscosity."""

    name: str
    parameters: dict[str, float]

    def force_N(self, still: Record) -> np.ndarray:
        model = DamperModel(self.name, "squeeze_biviscosity", 0.0, 0.0, self.parameters)
        return opened(model).simulate(motion(still), 1)


def plant_keys() -> dict[str, float]:
    """The damper of the frozen plant."""
    table: dict[str, Any] = tomllib.loads(default_plant().read_text(encoding="utf-8"))
    return {key: value for key, value in table["damper"].items() if key != "model"}


def sine(amplitude_m: float, freq_Hz: float, current_A: float, sensors: Sensors) -> Record:
    """A test as the disc moves, without force."""
    time_s = np.arange(sensors.samples) / sensors.rate_Hz
    w = 2.0 * np.pi * freq_Hz
    disp_m = amplitude_m * np.sin(w * time_s)
    zero = np.zeros(len(time_s))
    name = f"{1e3 * amplitude_m:g} mm, {freq_Hz:g} Hz, {current_A:g} A"
    return Record(
        name, sensors.rate_Hz, time_s, disp_m, amplitude_m * w * np.cos(w * time_s),
        -(w**2) * disp_m, zero, zero + current_A, "A",
    )  # fmt: skip


def rms(values: np.ndarray) -> float:
    return float(np.sqrt(np.mean(values**2)))


def films() -> list[Film]:
    """At the force of Table III with 3 A: the plant's damper, whose force_scale the rig does not
    share; and a film with the whole force on the cell, its yield stress that much lower, and a
    viscosity ratio that these speeds can show."""
    keys = plant_keys()
    wanted_N = float(np.hypot(*TABLE_III[-1].rms_N(*CELLS[0])))
    still = sine(*CELLS[0], CURRENTS_A[-1], Sensors())
    whole = {**keys, "force_scale": 1.0}
    full_N = rms(Film("plant, whole", whole).force_N(still))
    plant = Film("plant's film, scaled", {**keys, "force_scale": wanted_N / full_N})
    weak = {**whole, "viscosity_ratio": 0.01}
    coefficient = keys["yield_coefficient"]
    for _ in range(20):  # the force is all but proportional to the yield stress
        found_N = rms(Film("weak", {**weak, "yield_coefficient": coefficient}).force_N(still))
        coefficient *= wanted_N / found_N
    return [plant, Film("weak film, whole", {**weak, "yield_coefficient": coefficient})]


def recorded(
    film: Film, cell: tuple[float, float], current_A: float, seed: int, sensors: Sensors
) -> Record:
    """As `identify` has it: displacement low-passed and differentiated, the force as it is."""
    still = sine(*cell, current_A, sensors)
    rng = generator(seed, "squeeze rig", film.name, cell, current_A)
    lag_s = 1.0 / (2.0 * np.pi * sensors.disp_corner_Hz)
    count = len(still)
    disp_m = still.disp_m - lag_s * still.velocity_m_s
    si = {
        "displacement": disp_m + sensors.disp_noise_m * rng.standard_normal(count),
        "force": film.force_N(still) + sensors.force_noise_N * rng.standard_normal(count),
        "current": still.command,
    }
    raw = RawTest(still.name, still.name, 1.0 / still.rate_Hz, 0.0, still.time_s, si, 0.0)
    settings = Settings(sensors.low_pass_Hz, work_rate_Hz=sensors.rate_Hz, accept_values=True)
    return condition(raw, settings, [])


def without_noise(sensors: Sensors) -> Sensors:
    return replace(sensors, disp_noise_m=0.0, force_noise_N=0.0)


def table_iii_record(current_A: float) -> Record:
    """The force that Table III's Bouc-Wen model has at its own cell, without noise."""
    folder = default_plant().parent.parent / "dampers"
    still = sine(*CELLS[0], current_A, Sensors())
    _, simulate = simulator_of_file(folder / f"squeeze_2012_bouc_wen_{current_A:g}A.toml")
    return replace(still, force_N=simulate(still))
