"""A plant under a recorded acceleration of its base and currents given tick by tick, and the
slopes of what it does by those currents (sim_hil/python/plant_open_loop.h)."""

import ctypes
from ctypes import POINTER, byref, c_char_p, c_double, c_int, c_size_t, c_void_p
from dataclasses import dataclass, fields
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from quiesce.base.errors import UsageError, one_line
from quiesce.plant.library import ERROR_SIZE, call, library

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Motion:
    """True values at each tick, [ticks places] or [ticks dampers] in the order of the plant file;
    or slopes of one number by each of them."""

    disp_m: Floats  # of a place, relative to the base
    accel_m_s2: Floats  # absolute
    stroke_m: Floats  # of a damper
    force_N: Floats  # resisting
    coil_A: Floats

    @classmethod
    def zeros(cls, ticks: int, places: int, dampers: int) -> "Motion":
        widths = (places, places, dampers, dampers, dampers)
        return cls(*(np.zeros((ticks, width)) for width in widths))


@dataclass(frozen=True)
class BaseMotion:
    """Acceleration of the base [points] at n / rate_Hz, played time_scale times as fast, times
    gain; straight lines between, nothing after its end."""

    accel_m_s2: Floats
    rate_Hz: float
    time_scale: float = 1.0
    gain: float = 1.0


class _Shaking(ctypes.Structure):
    _fields_ = [
        ("tick_rate_Hz", c_int),
        ("ticks", c_size_t),
        ("points", c_size_t),
        ("time_s", POINTER(c_double)),
        ("accel_m_s2", POINTER(c_double)),
        ("time_scale", c_double),
        ("gain", c_double),
        ("step_factor", c_double),
    ]


class _Motion(ctypes.Structure):
    _fields_ = [(one.name, POINTER(c_double)) for one in fields(Motion)]


@cache
def _open_loop_library() -> Any:
    lib = library()
    lib.quiesce_open_loop_start.argtypes = [c_char_p, POINTER(_Shaking), c_char_p, c_size_t]
    lib.quiesce_open_loop_start.restype = c_void_p
    lib.quiesce_open_loop_free.argtypes = [c_void_p]
    lib.quiesce_open_loop_free.restype = None
    lib.quiesce_open_loop_max_current_A.argtypes = [c_void_p]
    lib.quiesce_open_loop_max_current_A.restype = c_double
    for name in ("place", "damper"):
        function = getattr(lib, f"quiesce_open_loop_{name}")
        function.argtypes = [c_void_p, c_size_t]
        function.restype = c_char_p
    lib.quiesce_open_loop_run.argtypes = [
        c_void_p, POINTER(c_double), c_int, POINTER(_Motion), c_char_p, c_size_t,
    ]  # fmt: skip
    lib.quiesce_open_loop_pull.argtypes = [
        c_void_p, POINTER(_Motion), POINTER(c_double), c_char_p, c_size_t,
    ]  # fmt: skip
    return lib


class OpenLoop:
    """One plant under one base motion, from rest. Not for several threads at once."""

    def __init__(
        self,
        plant: Path,
        base: BaseMotion,
        ticks: int,
        tick_rate_Hz: int = 1000,
        step_factor: float = 1.0,
    ) -> None:
        """step_factor: times the plant file's longest step, for searches, which are quicker then
        and not quite the same; how far that is stable is for the caller to see. UsageError for a
        plant that is wrong, or whose damper samples."""
        self._lib = _open_loop_library()
        accel = np.ascontiguousarray(base.accel_m_s2, dtype=float)
        time_s = np.arange(len(accel)) / base.rate_Hz
        shaking = _Shaking(
            tick_rate_Hz, ticks, len(accel), _at(time_s), _at(accel), base.time_scale, base.gain,
            step_factor,
        )  # fmt: skip
        error = ctypes.create_string_buffer(ERROR_SIZE)
        self._loop = self._lib.quiesce_open_loop_start(
            str(plant).encode(), byref(shaking), error, ERROR_SIZE
        )
        if not self._loop:
            raise UsageError(one_line(error.value.decode(errors="replace")))
        self.ticks = ticks
        self.tick_rate_Hz = tick_rate_Hz
        self.max_current_A = float(self._lib.quiesce_open_loop_max_current_A(self._loop))
        self.places = self._names(self._lib.quiesce_open_loop_place)
        self.dampers = self._names(self._lib.quiesce_open_loop_damper)

    def _names(self, name_of: Any) -> list[str]:
        names: list[str] = []
        while (name := name_of(self._loop, len(names))) is not None:
            names.append(name.decode())
        return names

    def run(self, command_A: Floats, *, is_rounded: bool = False) -> Motion:
        """command_A [ticks dampers]: what each driver puts out for the tick that begins with it, 0
        to its most; rounded to the driver's steps where is_rounded. UsageError for others, where
        a damper closes to the end of its range, and where the integration diverges."""
        command = np.ascontiguousarray(command_A, dtype=float)
        if command.shape != (self.ticks, len(self.dampers)):
            raise UsageError(
                f"a waveform of {command.shape} values; expected one for each of {self.ticks} "
                f"ticks and {len(self.dampers)} dampers"
            )
        motion = Motion.zeros(self.ticks, len(self.places), len(self.dampers))
        call(self._lib.quiesce_open_loop_run, self._loop, _at(command), int(is_rounded),
             byref(_pointers(motion)))  # fmt: skip
        return motion

    def pull(self, slopes: Motion) -> Floats:
        """Slopes [ticks dampers] of a number by the commands of the last run, from its slopes by
        what was recorded."""
        out = np.zeros((self.ticks, len(self.dampers)))
        call(self._lib.quiesce_open_loop_pull, self._loop, byref(_pointers(slopes)), _at(out))
        return out

    def __del__(self) -> None:
        if getattr(self, "_loop", None):
            self._lib.quiesce_open_loop_free(self._loop)


def _at(values: Floats) -> Any:
    return values.ctypes.data_as(POINTER(c_double))


def _pointers(motion: Motion) -> _Motion:
    """Arrays must be contiguous, as Motion.zeros makes them."""
    return _Motion(*(_at(getattr(motion, one.name)) for one in fields(Motion)))
