"""What the compiled library (targets/fmu/) says of a folder of resources."""

import ctypes
import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from quiesce.base.errors import UsageError, one_line
from quiesce.base.paths import build_folder
from quiesce.engine.bench import require_file

ERROR_SIZE = 1000


@dataclass(frozen=True)
class Variable:
    """Its value reference is its place among all."""

    name: str
    type: str  # real, integer, boolean
    causality: str  # parameter, input, output
    variability: str  # fixed, tunable, discrete, continuous
    unit: str  # "": none
    description: str
    start: float  # not of outputs
    min: float | None
    max: float | None


@dataclass(frozen=True)
class Description:
    tick_s: float
    variables: tuple[Variable, ...]


def library_file() -> Path:
    return require_file(build_folder() / "host/targets/fmu/libquiesce_fmu.so", "the library")


def describe(resources: Path) -> Description:
    """The model of resources. UsageError where the library refuses them."""
    library = ctypes.CDLL(str(library_file()))
    library.quiesce_fmu_describe.restype = ctypes.c_void_p
    library.quiesce_fmu_describe.argtypes = [ctypes.c_char_p, ctypes.c_char_p, ctypes.c_size_t]
    library.quiesce_fmu_free.argtypes = [ctypes.c_void_p]
    error = ctypes.create_string_buffer(ERROR_SIZE)
    text = library.quiesce_fmu_describe(str(resources).encode(), error, ERROR_SIZE)
    if not text:
        message = one_line(error.value.decode(errors="replace"))
        raise UsageError(message.replace(f"{resources}/", ""))
    try:
        found: dict[str, Any] = json.loads(ctypes.string_at(text))
    finally:
        library.quiesce_fmu_free(text)
    variables = tuple(Variable(**variable) for variable in found["variables"])
    return Description(found["tick_s"], variables)
