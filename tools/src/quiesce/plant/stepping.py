"""A plant in motion, tick by tick, for control laws that are written in Python.

run = Run(Plant(file), tick_rate_Hz=500)
while ...:
    now = run.advance(command_A=law(run.now), base_accel_m_s2=...)
"""

import ctypes
from ctypes import POINTER, byref, c_char_p, c_double, c_int, c_size_t, c_void_p
from functools import cache
from typing import Any

from quiesce.base.errors import UsageError, one_line
from quiesce.plant.library import ERROR_SIZE, Plant, call, library


class Now(ctypes.Structure):
    """True values at one tick: at the sensor disp_m, velocity_m_s (relative to the base) and
    accel_m_s2 (absolute); of the damper stroke_m, stroke_velocity_m_s, damper_force_N (resisting),
    coil_A, and fluid_C, NaN where it keeps no temperature."""

    _fields_ = [
        (name, c_double)
        for name in (
            "disp_m", "velocity_m_s", "accel_m_s2", "stroke_m", "stroke_velocity_m_s",
            "damper_force_N", "coil_A", "fluid_C",
        )
    ]  # fmt: skip


class _Acting(ctypes.Structure):
    _fields_ = [(name, c_double) for name in ("force_N", "base_accel_m_s2", "command_A")]


@cache
def _stepping_library() -> Any:
    lib = library()
    lib.quiesce_run_start.argtypes = [c_void_p, c_int, POINTER(Now), c_char_p, c_size_t]
    lib.quiesce_run_start.restype = c_void_p
    lib.quiesce_run_free.argtypes = [c_void_p]
    lib.quiesce_run_free.restype = None
    lib.quiesce_run_advance.argtypes = [
        c_void_p, POINTER(_Acting), POINTER(Now), c_char_p, c_size_t,
    ]  # fmt: skip
    lib.quiesce_run_advance.restype = c_int
    return lib


class Run:
    """From rest, without current; the plant has one damper."""

    def __init__(self, plant: Plant, tick_rate_Hz: int = 1000) -> None:
        """UsageError where the rate is not 1 .. 1000000."""
        self.plant = plant
        self.now = Now()
        self._lib = _stepping_library()
        error = ctypes.create_string_buffer(ERROR_SIZE)
        self._run = self._lib.quiesce_run_start(
            plant.handle, tick_rate_Hz, byref(self.now), error, ERROR_SIZE
        )
        if not self._run:
            raise UsageError(one_line(error.value.decode(errors="replace")))

    def advance(
        self, command_A: float, *, force_N: float = 0.0, base_accel_m_s2: float = 0.0
    ) -> Now:
        """One tick on. The command holds for the tick; the shaker's force and the acceleration of
        the base go in straight lines to these values at its end. UsageError where the damper closes
        or the integration diverges. The result is written over by the next call."""
        acting = _Acting(force_N, base_accel_m_s2, command_A)
        call(self._lib.quiesce_run_advance, self._run, byref(acting), byref(self.now))
        return self.now

    def __del__(self) -> None:
        if getattr(self, "_run", None):
            self._lib.quiesce_run_free(self._run)
