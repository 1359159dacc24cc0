"""Least squares over the whole recording: spectra of the sweeps, samples of the dwells.

The residual is measured minus modelled, in units of the sensor's noise, so that its Jacobian gives
the standard errors. Dwells are simulated from rest by the plant's own library: amplitude, phase,
harmonics and the transients after current steps all count, the lag among them.
"""

import math
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from itertools import product
from pathlib import Path

import numpy as np
from scipy.optimize import least_squares

from quiesce.base.errors import UsageError
from quiesce.plant.library import Plant
from quiesce.plant_id.modes import Film, Modes, SweepModel, shaker_gain, structure_response
from quiesce.plant_id.plant_file import (
    Base,
    COARSE_rad,
    FINE_rad,
    modal_shapes,
    no_current_N_s_m,
    plant_table,
    plant_text,
)
from quiesce.plant_id.recording import Dwell, SweepRecording
from quiesce.plant_id.simulate import simulate
from quiesce.plant_id.sweep import Timeline

# Parameters that are positive or keep their sign vary by their logarithm; these do not.
LINEAR = ("delay_ms", "yield_exponent", "_phase_rad", "_damper_ratio", "base_N_s_m")
# Standard deviations of what is known before any recording: the logarithm of a mode's shape ratio
# at the sensor, and the ratio at a damper elsewhere.
SHAPE_RATIO_PRIOR = 1.0
DAMPER_RATIO_PRIOR = 10.0
# Starts: damper force over modal force, yield velocity over the velocity without current.
START_FORCES = (0.02, 0.06, 0.2, 0.6, 2.0)
START_YIELDS = (0.003, 0.02, 0.1, 0.5)
START_LAG_s = 0.005
# The fit moves a parameter at most by this logarithm, and these inside what a plant file allows.
REACH = 7.0
RANGES = {"yield_exponent": (0.1, 4.0), "base_N_s_m": (0.0, 1e9), "viscosity_ratio": (1e-12, 1.0)}
# A residual this large stands for a plant that cannot be simulated.
IMPOSSIBLE = 1e3


def is_linear(name: str) -> bool:
    return name.endswith(LINEAR)


@dataclass(frozen=True)
class Space:
    """The free parameters: their names and signs, and the values of all others."""

    names: tuple[str, ...]
    signs: np.ndarray
    fixed: dict[str, float]

    @staticmethod
    def of(values: dict[str, float], free: list[str]) -> "Space":
        fixed = {name: value for name, value in values.items() if name not in free}
        return Space(tuple(free), np.array([math.copysign(1.0, values[n]) for n in free]), fixed)

    def pack(self, values: dict[str, float]) -> np.ndarray:
        return np.array(
            [values[n] if is_linear(n) else math.log(abs(values[n])) for n in self.names]
        )

    def bounds(self, theta: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Lowest and highest theta that a fit from here may reach."""
        limits = np.array(
            [(-np.inf, np.inf) if is_linear(n) else (-REACH, REACH) for n in self.names]
        )
        low, high = theta + limits[:, 0], theta + limits[:, 1]
        for at, name in enumerate(self.names):
            if name in RANGES:
                edges = RANGES[name] if is_linear(name) else np.log(RANGES[name])
                low[at], high[at] = max(low[at], edges[0]), min(high[at], edges[1])
        return low, high

    def unpack(self, theta: np.ndarray) -> dict[str, float]:
        values = dict(self.fixed)
        for name, sign, value in zip(self.names, self.signs, theta, strict=True):
            values[name] = float(value if is_linear(name) else sign * math.exp(value))
        return values


@dataclass(frozen=True)
class Fit:
    """values: every parameter. errors: standard errors of the free ones, of the logarithm where
    the parameter varies by it."""

    values: dict[str, float]
    space: Space
    errors: np.ndarray
    covariance: np.ndarray
    misfit: float  # RMS residual over the noise

    @property
    def names(self) -> tuple[str, ...]:
        return self.space.names

    def error(self, name: str) -> float:
        return float(self.errors[self.names.index(name)]) if name in self.names else math.nan


def modes_of(values: dict[str, float], base: Base) -> Modes:
    """With the damper's own force without current."""
    count = sum(1 for name in values if name.endswith("_freq_Hz"))
    shapes = modal_shapes(base, values, count)
    film = Film(
        no_current_N_s_m(base, values),
        np.array([one["at_sensor"] for one in shapes]),
        np.array([one["at_damper"] for one in shapes]),
    )

    def column(key: str) -> np.ndarray:
        return np.array([values[f"mode{i}_{key}"] for i in range(1, count + 1)])

    return Modes(
        column("freq_Hz"),
        column("damping_ratio"),
        column("residue_m_s2_V"),
        values.get("corner_Hz", 0.0),
        1e-3 * values["delay_ms"],
        film,
    )


class DwellModel:
    """Simulates dwells; remembers what it simulated last, since most trials change few of them."""

    def __init__(self, recording: SweepRecording, dwells: list[Dwell], base: Base) -> None:
        self.recording = recording
        self.dwells = dwells
        self.base = base
        self.angle_rad = COARSE_rad
        self._plants: dict[str, Plant | None] = {}
        self._responses: dict[tuple[int, str, float], np.ndarray] = {}

    def measured(self, number: int) -> np.ndarray:
        part = self.dwells[number].part
        return self.recording.accel_m_s2[part.first : part.end]

    def timeline(self, number: int, phase_rad: float) -> Timeline:
        """One dwell, its drive as found in the recording; begins one sample before the drive."""
        dwell, rate_Hz = self.dwells[number], self.recording.rate_Hz
        samples = np.arange(-1, dwell.part.end - dwell.part.first)
        cycles = dwell.start_cycles + dwell.freq_Hz * samples / rate_Hz
        lead = dwell.part.first - 1 if dwell.part.first > 0 else 0
        current_A = self.recording.current_A[dwell.part.first : dwell.part.end]
        return Timeline(
            rate_Hz,
            np.full(len(samples), dwell.amplitude_V),
            cycles + phase_rad / (2.0 * np.pi),
            np.concatenate([self.recording.current_A[lead : lead + 1], current_A]),
        )

    def plant(self, values: dict[str, float]) -> tuple[str, Plant | None]:
        """The plant with these values, by its text; None where it is none."""
        text = plant_text(plant_table(self.base, values, "trial", 1.0, self.angle_rad), [], {})
        if text not in self._plants:
            while len(self._plants) > 8:
                del self._plants[next(iter(self._plants))]
            self._plants[text] = load_text(text)
        return text, self._plants[text]

    def response(self, number: int, values: dict[str, float]) -> np.ndarray | None:
        """Acceleration of one dwell; None where the plant cannot be simulated."""
        text, plant = self.plant(values)
        phase_rad = values[f"dwell{number + 1}_phase_rad"]
        key = (number, text, phase_rad)
        if plant is None:
            return None
        if key not in self._responses:
            while len(self._responses) > 4 * len(self.dwells):
                del self._responses[next(iter(self._responses))]
            try:
                line = self.timeline(number, phase_rad)
                self._responses[key] = simulate(plant, line).accel_m_s2[1:]
            except UsageError:
                return None
        return self._responses[key]

    def residual(self, number: int, values: dict[str, float]) -> np.ndarray:
        measured, modelled = self.measured(number), self.response(number, values)
        if modelled is None:
            return np.full(len(measured), IMPOSSIBLE)
        return (measured - modelled) / self.recording.noise_m_s2


def load_text(text: str) -> Plant | None:
    with tempfile.TemporaryDirectory(prefix="quiesce-") as folder:
        file = Path(folder) / "trial.toml"
        file.write_text(text, encoding="utf-8")
        try:
            return Plant(file)
        except UsageError:
            return None


def residual(sweep: SweepModel, dwell: DwellModel, values: dict[str, float]) -> np.ndarray:
    parts = [sweep.residual(modes_of(values, dwell.base))]
    parts += [dwell.residual(number, values) for number in range(len(dwell.dwells))]
    ratios = [value for name, value in values.items() if name.endswith("_shape_ratio")]
    parts.append(np.log(np.array(ratios)) / SHAPE_RATIO_PRIOR)
    ratios = [value for name, value in values.items() if name.endswith("_damper_ratio")]
    parts.append(np.array(ratios) / DAMPER_RATIO_PRIOR)
    return np.concatenate(parts)


def solve(
    residuals: Callable[[dict[str, float]], np.ndarray],
    space: Space,
    start: dict[str, float],
    max_nfev: int = 40,
) -> Fit:
    first = space.pack(start)
    low, high = space.bounds(first)
    fit = least_squares(
        lambda theta: residuals(space.unpack(theta)),
        np.clip(first, low, high),
        bounds=(low, high),
        x_scale="jac",
        method="trf",
        max_nfev=max_nfev,
        xtol=1e-8,
        ftol=1e-7,
    )
    freedom = max(1, len(fit.fun) - len(fit.x))
    misfit = math.sqrt(2.0 * fit.cost / freedom)
    # Where the model does not reach the noise, the errors grow with what is left.
    covariance = inverse_normal(fit.jac) * max(1.0, misfit**2)
    return Fit(space.unpack(fit.x), space, np.sqrt(np.diag(covariance)), covariance, misfit)


def inverse_normal(jacobian: np.ndarray) -> np.ndarray:
    """(J' J)^-1 with its columns scaled; infinite where nothing depends on a parameter."""
    scale = np.linalg.norm(jacobian, axis=0)
    seen = scale > 0.0
    scaled = jacobian[:, seen] / scale[seen]
    inverse = np.full((len(scale), len(scale)), np.inf)
    core = np.linalg.pinv(scaled.T @ scaled, hermitian=True) / np.outer(scale[seen], scale[seen])
    inverse[np.ix_(seen, seen)] = core
    return inverse


def mode_values(modes: Modes) -> dict[str, float]:
    values = {"delay_ms": 1e3 * modes.delay_s}
    for i in range(modes.count):
        values[f"mode{i + 1}_freq_Hz"] = float(modes.freq_Hz[i])
        values[f"mode{i + 1}_damping_ratio"] = float(modes.damping_ratio[i])
        values[f"mode{i + 1}_residue_m_s2_V"] = float(modes.residue_m_s2_V[i])
    if modes.corner_Hz > 0.0:
        values["corner_Hz"] = modes.corner_Hz
    return values


def damper_starts(dwell: DwellModel, modes: Modes) -> list[dict[str, float]]:
    """Trial dampers, scaled by what the structure does without current where it moves fastest."""
    base = dwell.base
    at_sensor2 = 1.0 / base.modal_mass_kg
    freq_Hz = np.array([d.freq_Hz for d in dwell.dwells])
    drive_V = np.array([d.amplitude_V for d in dwell.dwells])
    drive_V = drive_V * shaker_gain(freq_Hz, modes.corner_Hz, base.ref_freq_Hz)
    velocity = np.abs(structure_response(freq_Hz, modes)) * drive_V / (2.0 * np.pi * freq_Hz)
    force_N = float(np.median(np.abs(modes.residue_m_s2_V[0]) * drive_V)) / at_sensor2
    fastest = float(velocity.max())
    if base.model == "viscous":
        per_A = force_N / (fastest * base.ref_current_A)
        return [
            {"per_A_N_s_m": part * per_A, "base_N_s_m": 1e-3 * part * per_A * base.ref_current_A}
            for part in (0.01, 0.03, 0.1, 0.3, 1.0)
        ]
    return [
        {
            "force_scale": part * force_N / base.yield_force_N(1.0),
            "viscosity_ratio": min(1.0, yield_part * fastest / base.yield_velocity_m_s(1.0)),
            "yield_exponent": 1.0,
        }
        for part in START_FORCES
        for yield_part in START_YIELDS
    ]


def start_values(dwell: DwellModel, modes: Modes, noise_mg: float) -> dict[str, float]:
    """Modes from the sweep, and a lag as first guess; no damper yet."""
    values = {**mode_values(modes), "rise_s": START_LAG_s, "fall_s": START_LAG_s}
    values["noise_mg"] = noise_mg
    for i in range(2, modes.count + 1):
        values[f"mode{i}_shape_ratio"] = 1.0
        if not dwell.base.is_damper_at_sensor:
            values[f"mode{i}_damper_ratio"] = 1.0
    for number, one in enumerate(dwell.dwells, 1):
        values[f"dwell{number}_phase_rad"] = -2.0 * np.pi * one.freq_Hz * modes.delay_s
    return values


def signed(values: dict[str, float]) -> list[dict[str, float]]:
    """Each way that the modes may be signed at a damper that is not at the sensor."""
    names = [name for name in values if name.endswith("_damper_ratio")][:3]
    return [
        dict(zip(names, signs, strict=True)) for signs in product((1.0, -1.0), repeat=len(names))
    ]


def best_damper(dwell: DwellModel, modes: Modes, start: dict[str, float]) -> dict[str, float]:
    """start with the best of the trial dampers."""

    def cost(trial: dict[str, float]) -> float:
        residuals = (dwell.residual(n, trial) for n in range(len(dwell.dwells)))
        return sum(float(one @ one) for one in residuals)

    trials = [
        {**start, **damper, **signs}
        for damper in damper_starts(dwell, modes)
        for signs in signed(start)
    ]
    return min(trials, key=cost)


def fit_all(sweep: SweepModel, dwell: DwellModel, start: dict[str, float], free: list[str]) -> Fit:
    """Damper and lag first, with the structure held; then everything together."""
    structural = ("mode", "corner_Hz", "delay_ms", "base_N_s_m")
    first = [name for name in free if not name.startswith(structural) or "_damper_" in name]

    def dwells_only(values: dict[str, float]) -> np.ndarray:
        return np.concatenate([dwell.residual(n, values) for n in range(len(dwell.dwells))])

    if dwell.dwells:
        start = solve(dwells_only, Space.of(start, first), start).values

    def everything(values: dict[str, float]) -> np.ndarray:
        return residual(sweep, dwell, values)

    space = Space.of(start, free)
    start = solve(everything, space, start).values
    # What is left is the coarse steps' integration error: few fine ones take it out.
    dwell.angle_rad = FINE_rad
    return solve(everything, space, start, max_nfev=3)
