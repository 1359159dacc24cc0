"""A damper's map as words for the controller: what is in them, and why there are none."""

import re
import struct
import zlib

import numpy as np
import pytest
from conftest import ROOT
from damper_actions import dissipative_tanh, kwok_rd1005
from quiesce.damper.force_map import (
    LIMIT,
    MAGIC,
    MAX_CURRENTS,
    MAX_CURRENT_mA,
    map_words,
    why_no_map,
)
from quiesce.damper.inverse import Monotone, SteadyForces, monotone_range

pytestmark = pytest.mark.usefixtures("build")


def defined(header: str, name: str) -> int:
    text = (ROOT / "firmware" / header).read_text(encoding="utf-8")
    found = re.search(rf"#define {name} (?:UINT32_C\()?(\w+?)u?\)?(?: |$)", text, re.MULTILINE)
    assert found, name
    return int(found[1], 0)


def test_limits_are_those_of_the_firmware() -> None:
    assert defined("track/force_map.h", "FORCE_MAP_MAGIC") == MAGIC
    assert defined("track/force_map.h", "FORCE_MAP_MAX_CURRENTS") == MAX_CURRENTS
    assert defined("include/quiesce_board.h", "QUIESCE_HIGHEST_CURRENT_mA") == MAX_CURRENT_mA
    assert "VIEW_LIMIT ((1 << 30) - 1)" in (ROOT / "firmware/base/view.h").read_text("utf-8")
    assert LIMIT == (1 << 30) - 1


def unpacked(words: list[int]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Velocities, currents, forces, after what stands before them is as it should be."""
    magic, crc, count, n, m = words[:5]
    assert magic == MAGIC and count == len(words) == 5 + n + m + n * m
    assert crc == zlib.crc32(struct.pack(f"<{count - 2}I", *words[2:]))
    values = np.array(words[5:], dtype=np.uint32).view(np.int32)
    return values[:n], values[n : n + m], values[n + m :].reshape(n, m)


def made(velocities: list[float], currents: list[float], forces: list[list[float]]) -> Monotone:
    """A check's result: forces in the direction of the motion, rising where they do."""
    steady = SteadyForces(np.array(velocities), np.array(currents), np.array(forces))
    limits = np.full(len(velocities), currents[-1])
    return Monotone(currents[-1], limits, steady)


def test_words_are_the_forces_of_the_model() -> None:
    damper = dissipative_tanh()
    velocities, currents, forces = unpacked(map_words(monotone_range(damper, 2.0)))
    assert list(velocities) == [-300000, -90000, -30000, -9000, 9000, 30000, 90000, 300000]
    assert len(currents) == MAX_CURRENTS and currents[0] == 0 and currents[-1] == 2000
    speed, i = 1e-6 * velocities[:, None], 1e-3 * currents[None, :]
    size = 40.0 + 900.0 * i - 150.0 * i**2
    expected = (600.0 + 700.0 * i) * speed + size * np.tanh(60.0 * speed)
    # Between two currents of the check's 201 the force is a straight line.
    assert 1e-3 * forces == pytest.approx(expected, abs=0.01)


def test_map_ends_where_some_force_stops_rising() -> None:
    found = monotone_range(kwok_rd1005(), 3.0)
    velocities, currents, forces = unpacked(map_words(found))
    assert currents[-1] == int(1e3 * found.limit_A) == pytest.approx(1880, abs=100)
    along = np.sign(velocities)[:, None] * forces
    assert (np.diff(along, axis=1) >= 0).all()


def test_what_rounding_leaves_of_a_fall_is_levelled() -> None:
    forces = [[100.0, 200.0, 199.9994], [10.0, 20.0, 30.0]]
    _, _, words = unpacked(map_words(made([-0.1, 0.1], [0.0, 1.0, 2.0], forces)))
    assert (np.diff(-words[0]) >= 0).all() and -words[0][-1] == 200000


def test_small_currents_stand_once() -> None:
    found = made([-0.1, 0.1], [0.0, 0.004], [[1.0, 5.0], [1.0, 5.0]])
    velocities, currents, forces = unpacked(map_words(found))
    assert list(velocities) == [-100000, 100000] and list(currents) == [0, 1, 2, 3, 4]
    assert list(forces[1]) == [1000, 2000, 3000, 4000, 5000]
    assert list(forces[0]) == [-1000, -2000, -3000, -4000, -5000]


BOTH = [[1.0, 5.0], [1.0, 5.0]]


@pytest.mark.parametrize(
    ("found", "why"),
    [
        (made([-0.1, 0.1], [0.0, 20.001], BOTH), "20.001 A is more than 20 A"),
        (made([-0.1, 0.1], [0.0, 1.0], [[1.0, 5.0], [1.0, 2e6]]), "a force of 2e+06 N"),
        (made([0.1, 0.2], [0.0, 1.0], BOTH), "both ways"),
        (made([-1e-7, 1e-7], [0.0, 1.0], BOTH), "whole um/s"),
        (made([-0.1, 1074.0], [0.0, 1.0], BOTH), "1073 m/s"),
        (made([-0.1, 0.1], [0.0, 1.0], [[1.0, 1.0], [1.0, 1.0999]]), "99.9 mN at most"),
        (
            Monotone(0.0, np.array([1.0, 0.0]), made([-0.1, 0.1], [0.0, 1.0], BOTH).forces),
            "at 0.1 m/s the force falls with the current from 0 A on",
        ),
    ],
)
def test_no_map_has_a_reason_of_one_line(found: Monotone, why: str) -> None:
    told = why_no_map(found)
    assert why in told and "\n" not in told
    with pytest.raises(ValueError, match="."):
        map_words(found)
