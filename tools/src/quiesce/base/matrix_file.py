"""Matrices of a structure from the CSV files that a plant file names, in place of their names."""

from pathlib import Path
from typing import Any

from quiesce.base.errors import UsageError
from quiesce.base.paths import shown

KEYS = ("mass_kg", "damping_N_s_m", "stiffness_N_m")


def with_own_matrices(structure: dict[str, Any], folder: Path) -> dict[str, Any]:
    """A copy of a plant's [structure] that needs no file beside it. UsageError where one cannot be
    read; the bench says what else is wrong in them."""
    out = dict(structure)
    for key in KEYS:
        name = out.pop(f"{key}_file", None)
        if name is not None:
            out[key] = read_matrix(folder / str(name))
    return out


def read_matrix(file: Path) -> list[list[float]]:
    """Lines of numbers with commas between them, without a header."""
    try:
        lines = file.read_text(encoding="utf-8-sig").splitlines()
        return [[float(cell) for cell in line.split(",")] for line in lines if line.strip()]
    except OSError as error:
        raise UsageError(f"{shown(file)}: {error.strerror}; name a CSV file of numbers")
    except ValueError:
        raise UsageError(f"{shown(file)}: expected lines of numbers with commas between them")
