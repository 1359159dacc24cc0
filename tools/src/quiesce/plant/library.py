"""The simulated plant, by its C library (sim_hil/python/plant_library.h)."""

import ctypes
from ctypes import POINTER, c_char_p, c_double, c_int, c_size_t, c_void_p
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

from quiesce.base.errors import UsageError, one_line
from quiesce.base.paths import build_folder
from quiesce.engine.bench import require_file

ERROR_SIZE = 1000
# Of the integration where a plant file says none; of the longest safe one where that is shorter.
USUAL_STEP_us, SAFE_PART = 500.0, 0.9


class _Facts(ctypes.Structure):
    _fields_ = [
        ("max_current_A", c_double),
        ("drive_V", c_double),
        ("max_step_s", c_double),
        ("safe_step_s", c_double),
        ("rise_s", c_double),
        ("fall_s", c_double),
        ("driver_bits", c_int),
        ("mode_count", c_int),
    ]


class _Mode(ctypes.Structure):
    _fields_ = [
        (name, c_double)
        for name in ("freq_Hz", "damping_ratio", "at_force", "at_damper", "at_sensor")
    ]


@dataclass(frozen=True)
class Mode:
    """One mode of the structure; shapes are mass-normalised, in kg^-1/2."""

    freq_Hz: float
    damping_ratio: float
    at_force: float
    at_damper: float
    at_sensor: float


def library_file() -> Path:
    path = build_folder() / "host/sim_hil/python/libquiesce_plant.so"
    return require_file(path.resolve(), "the plant library")


@cache
def library() -> ctypes.CDLL:
    """The library, with the types of its plant functions declared."""
    lib = ctypes.CDLL(str(library_file()))
    lib.quiesce_plant_load.argtypes = [c_char_p, c_char_p, c_size_t]
    lib.quiesce_plant_load.restype = c_void_p
    lib.quiesce_plant_free.argtypes = [c_void_p]
    lib.quiesce_plant_free.restype = None
    lib.quiesce_plant_get_facts.argtypes = [c_void_p, POINTER(_Facts)]
    lib.quiesce_plant_get_facts.restype = None
    lib.quiesce_plant_get_mode.argtypes = [c_void_p, c_int, POINTER(_Mode)]
    lib.quiesce_plant_get_mode.restype = None
    lib.quiesce_plant_shaker_per_V.argtypes = [c_void_p, c_double]
    lib.quiesce_plant_shaker_per_V.restype = c_double
    return lib


def call(function: Any, *arguments: Any) -> None:
    """Calls a library function that ends with (error, error_size); UsageError where it fails."""
    error = ctypes.create_string_buffer(ERROR_SIZE)
    if function(*arguments, error, ERROR_SIZE) != 0:
        raise UsageError(one_line(error.value.decode(errors="replace")))


class Plant:
    """One plant file. Immutable; pickles as its path."""

    def __init__(self, file: Path | str) -> None:
        """UsageError with file, key and what is allowed where the file is wrong."""
        self.file = Path(file)
        error = ctypes.create_string_buffer(ERROR_SIZE)
        self._lib = library()
        self.handle = self._lib.quiesce_plant_load(str(file).encode(), error, ERROR_SIZE)
        if not self.handle:
            raise UsageError(one_line(error.value.decode(errors="replace")))
        self._read_facts()

    def _read_facts(self) -> None:
        facts = _Facts()
        self._lib.quiesce_plant_get_facts(self.handle, ctypes.byref(facts))
        self.max_current_A = facts.max_current_A
        self.drive_V = facts.drive_V
        self.max_step_s = facts.max_step_s
        self.safe_step_s = facts.safe_step_s
        self.rise_s = facts.rise_s
        self.fall_s = facts.fall_s
        self.driver_bits = facts.driver_bits
        self.modes = tuple(self._mode(i) for i in range(facts.mode_count))

    def _mode(self, index: int) -> Mode:
        mode = _Mode()
        self._lib.quiesce_plant_get_mode(self.handle, index, ctypes.byref(mode))
        return Mode(*(getattr(mode, name) for name, _ in _Mode._fields_))

    def shaker_per_V(self, freq_Hz: float) -> float:
        """Amplitude of the shaker for 1 V: N, or m/s2 where it moves the base."""
        return self._lib.quiesce_plant_shaker_per_V(self.handle, freq_Hz)

    def __reduce__(self) -> tuple[type["Plant"], tuple[Path]]:
        return Plant, (self.file,)

    def __del__(self) -> None:
        if getattr(self, "handle", None):
            self._lib.quiesce_plant_free(self.handle)
