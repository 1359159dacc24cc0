"""A structure's matrices from its plant file, seen from the board's bodies and dampers."""

import tomllib
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from quiesce.base.errors import UsageError, one_line
from quiesce.base.matrix_file import with_own_matrices
from quiesce.base.paths import shown


@dataclass(frozen=True)
class Structure:
    """M q'' + C q' + K q = -dampers' F - M base a_g, q relative to the base, in SI units.

    bodies [bodies n]: what q gives each body; bodies_base [bodies]: how far it moves with the base.
    dampers [dampers n]: strokes; F resists a stroke that grows.
    """

    mass: np.ndarray
    damping: np.ndarray
    stiffness: np.ndarray
    base: np.ndarray
    bodies: np.ndarray
    bodies_base: np.ndarray
    dampers: np.ndarray


def load_structure(file: Path, bodies: Sequence[str], dampers: Sequence[str]) -> Structure:
    """UsageError, in one line, where it has no matrices, or no place or damper of a name."""
    data = _read(file)
    section = with_own_matrices(data.get("structure", {}), file.parent)
    if section.get("kind") != "matrices":
        raise UsageError(
            f"{shown(file)}: its structure is given by modes; this law is made from matrices "
            '(kind = "matrices")'
        )
    try:
        mass, damping, stiffness = (
            np.array(section[key], dtype=float)
            for key in ("mass_kg", "damping_N_s_m", "stiffness_N_m")
        )
        base = np.array(section.get("base", np.ones(len(mass))), dtype=float)
        places = {one["name"]: np.array(one["at"], dtype=float) for one in data.get("place", [])}
        strokes = {one["name"]: _stroke(one, places) for one in data.get("damper", [])}
        at = np.array([places[name] for name in bodies])
        return Structure(
            mass, damping, stiffness, base, at, at @ base,
            np.array([strokes[name] for name in dampers]),
        )  # fmt: skip
    except KeyError as error:
        raise UsageError(f"{shown(file)}: nothing is called {error.args[0]!r} there")
    except (TypeError, ValueError) as error:
        raise UsageError(f"{shown(file)}: {one_line(error)}; quiesce plant check FILE says more")


def _read(file: Path) -> dict[str, Any]:
    try:
        return tomllib.loads(file.read_text(encoding="utf-8"))
    except OSError as error:
        raise UsageError(f"{shown(file)}: {error.strerror}; name a plant file")
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise UsageError(f"{shown(file)}: not a TOML file: {one_line(error)}")


def _stroke(damper: dict[str, Any], places: dict[str, np.ndarray]) -> np.ndarray:
    a = places[damper["a"]]
    return a if damper["b"] == "ground" else a - places[damper["b"]]
