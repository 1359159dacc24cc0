"""The plant's periodic motion under a sinusoidal force and a periodic current command.

Angles are in degrees of the excitation, F = drive g(f) sin(theta). A command is an array of n
currents, each held for one of n equal parts of half a period (and again in the second half), or of
the whole period. Continuous in time: no control ticks, no rounding of the current.
"""

import ctypes
from ctypes import POINTER, c_char_p, c_double, c_int, c_size_t, c_void_p
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from quiesce.base.errors import UsageError
from quiesce.plant.library import Plant, call, library

Floats = NDArray[np.float64]
FIGURES = (
    "amp_m",
    "rms_disp_m",
    "accel_rms_m_s2",
    "mean_current_A",
    "disp_fundamental_m",
    "disp_phase_rad",
    "accel_fundamental_m_s2",
    "accel_phase_rad",
    "residual",
)


class _Case(ctypes.Structure):
    _fields_ = [
        ("freq_Hz", c_double),
        ("drive_V", c_double),
        ("intervals", c_int),
        ("covers_period", c_int),
    ]


class _Figures(ctypes.Structure):
    _fields_ = [*((name, c_double) for name in FIGURES), ("periods", c_int)]


class _Orbit(ctypes.Structure):
    _fields_ = [
        ("figures", _Figures),
        ("start", POINTER(c_double)),
        ("disp_m", POINTER(c_double)),
        ("accel_m_s2", POINTER(c_double)),
        ("coil_A", POINTER(c_double)),
        ("disp_per_A", POINTER(c_double)),
        ("accel_per_A", POINTER(c_double)),
    ]


@cache
def _periodic_library() -> Any:
    lib = library()
    lib.quiesce_orbit_grid.argtypes = [c_void_p, POINTER(_Case)]
    lib.quiesce_orbit_grid.restype = c_size_t
    lib.quiesce_orbit_state_count.argtypes = [c_void_p]
    lib.quiesce_orbit_state_count.restype = c_size_t
    lib.quiesce_orbit_solve.argtypes = [
        c_void_p,
        POINTER(_Case),
        POINTER(c_double),
        POINTER(_Orbit),
        c_char_p,
        c_size_t,
    ]
    lib.quiesce_orbit_solve.restype = c_int
    return lib


@dataclass(frozen=True)
class Orbit:
    """One period of steady state; arrays over theta = 360 k / grid degrees."""

    amp_m: float  # half peak-to-peak displacement at the sensor
    rms_disp_m: float
    accel_rms_m_s2: float
    mean_current_A: float  # of the coil
    disp_fundamental_m: float
    disp_phase_deg: float  # x ~ disp_fundamental_m cos(theta + disp_phase_deg)
    accel_fundamental_m_s2: float
    accel_phase_deg: float
    residual: float  # relative change of the state over the period
    periods: int  # simulated to find it
    state: Floats  # at theta = 0
    disp_m: Floats  # [grid]
    accel_m_s2: Floats  # [grid]
    coil_A: Floats  # [grid]
    disp_per_A: Floats | None  # [grid, n], where sensitivities were asked for
    accel_per_A: Floats | None  # [grid, n]

    @property
    def tracked_deg(self) -> float:
        """Phase of the displacement as the controller knows it, from the accelerometer: opposite to
        the acceleration's. On a base that moves that is the motion in space."""
        return self.accel_phase_deg - 180.0


@dataclass(frozen=True)
class Drive:
    """What shakes: a sine, as frequency and amplitude of the shaker's voltage."""

    plant: Plant
    freq_Hz: float
    drive_V: float


def drive(plant: Plant, freq_Hz: float, drive_V: float | None = None) -> Drive:
    """drive_V: the plant file's where it is None."""
    return Drive(plant, freq_Hz, plant.drive_V if drive_V is None else drive_V)


def solve(
    drive: Drive,
    command_A: Floats | float,
    *,
    covers_period: bool = False,
    start: Floats | None = None,
    sensitive: bool = False,
) -> Orbit:
    """The orbit for a command [n]; start: the state of a similar orbit, which saves time.

    UsageError where the command is outside 0 .. max_current_A or no orbit is found.
    """
    lib = _periodic_library()
    command = np.ascontiguousarray(np.atleast_1d(command_A), dtype=np.float64)
    case = _Case(drive.freq_Hz, drive.drive_V, len(command), covers_period)
    grid = lib.quiesce_orbit_grid(drive.plant.handle, ctypes.byref(case))
    if grid == 0:
        raise UsageError(f"no orbit at {drive.freq_Hz} Hz, {drive.drive_V} V")
    states = lib.quiesce_orbit_state_count(drive.plant.handle)
    state = np.full(states, np.nan) if start is None else np.array(start, dtype=np.float64)
    waves = np.empty((3, grid))
    slopes = np.empty((2, grid, len(command))) if sensitive else None
    out = _Orbit(_Figures(), _pointer(state), *map(_pointer, waves), *_slope_pointers(slopes))
    call(
        lib.quiesce_orbit_solve,
        drive.plant.handle,
        ctypes.byref(case),
        _pointer(command),
        ctypes.byref(out),
    )
    return _orbit(out.figures, state, waves, slopes)


def _pointer(values: Floats) -> Any:
    return values.ctypes.data_as(POINTER(c_double))


def _slope_pointers(slopes: Floats | None) -> tuple[Any, Any]:
    return (None, None) if slopes is None else (_pointer(slopes[0]), _pointer(slopes[1]))


def _orbit(figures: _Figures, state: Floats, waves: Floats, slopes: Floats | None) -> Orbit:
    return Orbit(
        figures.amp_m,
        figures.rms_disp_m,
        figures.accel_rms_m_s2,
        figures.mean_current_A,
        figures.disp_fundamental_m,
        float(np.degrees(figures.disp_phase_rad)),
        figures.accel_fundamental_m_s2,
        float(np.degrees(figures.accel_phase_rad)),
        figures.residual,
        figures.periods,
        state,
        *waves,
        *((None, None) if slopes is None else slopes),
    )
