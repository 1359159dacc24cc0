"""The simulated plant in time, driven tick by tick, and what its sensor would record."""

import ctypes
import tomllib
from ctypes import POINTER, c_char_p, c_double, c_int, c_size_t, c_void_p
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np

from quiesce.plant.library import Plant, call
from quiesce.plant.library import library as plant_library
from quiesce.plant_id.sweep import Timeline

GRAVITY_m_s2 = 9.80665


class _Drive(ctypes.Structure):
    _fields_ = [
        ("tick_rate_Hz", c_int),
        ("ticks", c_size_t),
        ("amplitude_V", POINTER(c_double)),
        ("phase_cycles", POINTER(c_double)),
        ("command_A", POINTER(c_double)),
    ]


class _Response(ctypes.Structure):
    _fields_ = [(name, POINTER(c_double)) for name in ("accel_m_s2", "disp_m", "coil_A")]


@dataclass(frozen=True)
class Response:
    """True values at each tick."""

    accel_m_s2: np.ndarray
    disp_m: np.ndarray
    coil_A: np.ndarray


@cache
def library() -> ctypes.CDLL:
    lib = plant_library()
    lib.quiesce_plant_simulate.argtypes = [
        c_void_p,
        POINTER(_Drive),
        POINTER(_Response),
        c_char_p,
        c_size_t,
    ]
    lib.quiesce_plant_simulate.restype = c_int
    return lib


def pointer(values: np.ndarray):
    return values.ctypes.data_as(POINTER(c_double))


def finer(line: Timeline, factor: int) -> Timeline:
    """The same drive with `factor` ticks in place of one; a command still holds for all of them."""
    ticks = np.arange(len(line.amplitude_V))
    at = np.arange(factor * len(ticks)) / factor
    return Timeline(
        factor * line.rate_Hz,
        np.interp(at, ticks, line.amplitude_V),
        np.interp(at, ticks, line.phase_cycles),
        np.repeat(line.current_A, factor),
    )


def simulate(plant: Plant, line: Timeline) -> Response:
    """From rest. UsageError where the damper closes or the integration diverges."""
    arrays = [
        np.ascontiguousarray(values, dtype=float)
        for values in (line.amplitude_V, line.phase_cycles, line.current_A)
    ]
    drive = _Drive(line.rate_Hz, len(arrays[0]), *map(pointer, arrays))
    outputs = [np.empty(len(arrays[0])) for _ in range(3)]
    response = _Response(*map(pointer, outputs))
    call(
        library().quiesce_plant_simulate,
        plant.handle,
        ctypes.byref(drive),
        ctypes.byref(response),
    )
    return Response(*outputs)


@dataclass(frozen=True)
class Sensor:
    """An accelerometer with its converter, as a plant file's [sensor] describes it."""

    full_scale_g: float
    bits: int
    noise_mg: float
    offset_counts: int

    @staticmethod
    def of(plant_file: Path) -> "Sensor":
        section = tomllib.loads(plant_file.read_text(encoding="utf-8"))["sensor"]
        return Sensor(
            float(section["full_scale_g"]),
            int(section["bits"]),
            float(section.get("noise_mg", 0.0)),
            int(section.get("offset_counts", 0)),
        )

    def record(self, accel_m_s2: np.ndarray, seed: int) -> np.ndarray:
        """What it reads, in m/s2: noise, rounding to counts, saturation, offset."""
        count_m_s2 = self.full_scale_g * GRAVITY_m_s2 / 2 ** (self.bits - 1)
        noise_m_s2 = 1e-3 * GRAVITY_m_s2 * self.noise_mg
        noisy = accel_m_s2 + noise_m_s2 * np.random.default_rng(seed).standard_normal(
            len(accel_m_s2)
        )
        limit = 2 ** (self.bits - 1) - 1
        counts = np.rint(noisy / count_m_s2) + self.offset_counts
        return np.clip(counts, -limit, limit) * count_m_s2


# Ticks in one of a simulated recording: finer steps than the identification takes itself.
RECORDED_FINER = 8


def record(plant: Plant, line: Timeline, seed: int) -> np.ndarray:
    """What the plant's sensor reads of this drive, in m/s2."""
    truth = simulate(plant, finer(line, RECORDED_FINER))
    return Sensor.of(plant.file).record(truth.accel_m_s2[::RECORDED_FINER], seed)
