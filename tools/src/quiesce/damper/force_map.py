"""Dampers' maps as the controller takes them: words of integers, for tracker `inverse`.

firmware/track/force_map.h describes the words; it checks them again.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from quiesce.damper.inverse import AXES, Axis, Monotone, SteadyForces
from quiesce.law.sections import read_kind, sealed_sections
from quiesce.table.kinds import MAP
from quiesce.table.words import Reader

MAGIC = MAP.magic
SECTION_WORDS = 3
MAX_CURRENTS = 16
MAX_PLACES = 32
MIN_POINTS = 2  # of either axis
MAX_CURRENT_mA = 20000
LIMIT = 2**30 - 1  # of a force in mN and of a place in um/s or nm
# Forces are whole mN: less than this between no current and the largest one is told too coarsely.
LEAST_RANGE_mN = 100


def why_no_map(found: Monotone) -> str:
    """One line; empty where there is a map."""
    forces = found.forces
    axis, lowest = forces.axis, int(np.argmin(found.per_place_A))
    most_mA = top_mA(found)
    largest_N = float(np.abs(forces.force_N).max())
    if most_mA < 1:
        place = f"{forces.places[lowest]:.4g} {axis.unit}"
        return f"at {place} the force falls with the current from 0 A on"
    if most_mA > MAX_CURRENT_mA:
        return f"{most_mA / 1e3:g} A is more than {MAX_CURRENT_mA / 1e3:g} A; --max-current-A"
    if 1e3 * largest_N > LIMIT:
        return f"a force of {largest_N:.4g} N is more than {LIMIT / 1e3:.0f} N"
    if not _is_axis(_fine_places(forces)):
        most = f"{LIMIT // 10**6 / (1e-6 * axis.per_unit):g} {axis.unit}"
        return f"its places do not differ by whole {axis.fine_unit} both ways, or pass {most}"
    spread_mN = float(1e3 * np.ptp(_resampled_N(found), axis=1).max())
    if spread_mN < LEAST_RANGE_mN:
        return (
            f"the current changes the force by {spread_mN:.3g} mN at most, and forces are whole mN"
        )
    return ""


def map_words(found: Monotone) -> list[int]:
    """What the firmware loads, one section, up to the current where some force stops rising.
    ValueError where `why_no_map` says something."""
    if why := why_no_map(found):
        raise ValueError(why)
    places, currents = _fine_places(found.forces), _currents_mA(found)
    # What integration and rounding leave of a fall is less than a part in a million: levelled.
    along = np.maximum.accumulate(np.rint(1e3 * _resampled_N(found)).astype(int), axis=1)
    forces = np.sign(places)[:, None] * along  # > 0 resists a stroke that grows
    return sealed_sections(MAGIC, [_section(found.forces.axis, places, currents, forces)], "map")


def _section(axis: Axis, places: np.ndarray, currents: np.ndarray, forces: np.ndarray) -> list[int]:
    """Of the axis' units, mA and mN."""
    values = [axis.word, len(places), len(currents)]
    return values + [int(value) for part in (places, currents, forces.ravel()) for value in part]


def joined(tables: Sequence[Sequence[int]]) -> list[int]:
    """One table for several dampers: the sections of all, in this order. ValueError, in one line,
    where one is no map, or they are too many or too long for a controller."""
    return sealed_sections(MAGIC, [one for words in tables for one in _sections(words)], "map")


@dataclass(frozen=True)
class Map:
    """Of one damper: places and currents rising, forces_N [places, currents], > 0 resists a stroke
    that grows."""

    axis: Axis
    places: np.ndarray
    currents_A: np.ndarray
    forces_N: np.ndarray


def words_of_map(wanted: Map) -> list[int]:
    """ValueError, in one line, for a map that the firmware refuses."""
    parts = (
        np.rint(unit * values).astype(int)
        for unit, values in (
            (wanted.axis.per_unit, wanted.places), (1e3, wanted.currents_A), (1e3, wanted.forces_N)
        )
    )  # fmt: skip
    words = sealed_sections(MAGIC, [_section(wanted.axis, *parts)], "map")
    maps_of_words(words)
    return words


def maps_of_words(words: Sequence[int]) -> tuple[Map, ...]:
    """A section each. ValueError, in one line, for words that the firmware refuses
    (firmware/track/force_map.h)."""
    return tuple(_map_of(section) for section in _sections(words))


def _sections(words: Sequence[int]) -> tuple[list[int], ...]:
    """Signed words of each. ValueError where head or sizes are not right."""
    return read_kind(MAGIC, words, _taken, "map")


def _taken(reader: Reader) -> list[int]:
    head = reader.take(SECTION_WORDS)
    n, m = head[1:]
    if not (MIN_POINTS <= n <= MAX_PLACES and MIN_POINTS <= m <= MAX_CURRENTS):
        raise ValueError(f"{n} places and {m} currents are not the shape of a map")
    return head + reader.take(n + m + n * m)


def _map_of(section: Sequence[int]) -> Map:
    word, n, m = section[:SECTION_WORDS]
    axis = next((one for one in AXES.values() if one.word == word), None)
    if axis is None:
        raise ValueError(f"{word} is no axis of a map")
    values = np.array(section[SECTION_WORDS:])
    places, currents, forces = values[:n], values[n : n + m], values[n + m :].reshape(n, m)
    along = np.sign(places)[:, None] * forces
    is_current = (np.diff(currents) > 0).all() and currents[0] == 0
    if not (_is_axis(places) and is_current and currents[-1] <= MAX_CURRENT_mA):
        raise ValueError("its places or currents do not rise within their limits")
    if np.abs(forces).max() > LIMIT or not (np.diff(along, axis=1) >= 0).all():
        raise ValueError("a force goes the wrong way with the current, or is too large")
    if np.diff(forces[places == 0], axis=1).any():
        raise ValueError("a force follows the current at rest")
    return Map(axis, places / axis.per_unit, 1e-3 * currents, 1e-3 * forces)


def top_mA(found: Monotone) -> int:
    """The largest current of the map."""
    return int(1e3 * found.limit_A * (1.0 + 1e-12))


def _fine_places(forces: SteadyForces) -> np.ndarray:
    return np.rint(forces.axis.per_unit * forces.places).astype(int)


def _is_axis(fine: np.ndarray) -> bool:
    return bool((np.diff(fine) > 0).all() and -LIMIT <= fine[0] < 0 < fine[-1] <= LIMIT)


def _currents_mA(found: Monotone) -> np.ndarray:
    return np.unique(np.rint(np.linspace(0.0, top_mA(found), MAX_CURRENTS)).astype(int))


def _resampled_N(found: Monotone) -> np.ndarray:
    """In the direction of the axis, at the map's currents."""
    currents_A = 1e-3 * _currents_mA(found)
    forces = found.forces
    return np.stack([np.interp(currents_A, forces.currents_A, row) for row in forces.force_N])
