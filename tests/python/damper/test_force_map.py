"""A damper's map as words for the controller: what is in them, and why there are none."""

import re
import struct
import zlib
from pathlib import Path

import numpy as np
import pytest
from conftest import ROOT
from damper_actions import dissipative_tanh, kwok_rd1005
from quiesce.base.errors import UsageError
from quiesce.base.paths import root
from quiesce.cli.main import main
from quiesce.damper.force_map import (
    LIMIT,
    MAGIC,
    MAX_CURRENTS,
    MAX_PLACES,
    MAX_CURRENT_mA,
    joined,
    map_words,
    maps_of_words,
    why_no_map,
)
from quiesce.damper.inverse import STROKE, VELOCITY, Axis, Monotone, SteadyForces, monotone_range
from quiesce.damper.simulate import simulator_of_file
from quiesce.law.sections import MOST_SECTIONS
from quiesce.table.file import read_words

pytestmark = pytest.mark.usefixtures("build")


def defined(header: str, name: str) -> int:
    text = (ROOT / "firmware" / header).read_text(encoding="utf-8")
    found = re.search(rf"#define {name} (?:UINT32_C\()?(\w+?)u?\)?(?: |$)", text, re.MULTILINE)
    assert found, name
    return int(found[1], 0)


def test_limits_are_those_of_the_firmware() -> None:
    assert defined("track/force_map.h", "FORCE_MAP_MAGIC") == MAGIC
    assert defined("track/force_map.h", "FORCE_MAP_MAX_CURRENTS") == MAX_CURRENTS
    assert defined("track/force_map.h", "FORCE_MAP_MAX_PLACES") == MAX_PLACES
    assert defined("include/quiesce_size.h", "QUIESCE_MAX_DAMPERS") == MOST_SECTIONS
    assert defined("include/quiesce_board.h", "QUIESCE_HIGHEST_CURRENT_mA") == MAX_CURRENT_mA
    assert "VIEW_LIMIT ((1 << 30) - 1)" in (ROOT / "firmware/base/view.h").read_text("utf-8")
    assert LIMIT == (1 << 30) - 1


def unpacked(words: list[int]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Places, currents, forces, after what stands before them is as it should be."""
    magic, crc, count, sections, axis, n, m = words[:7]
    assert magic == MAGIC and count == len(words) == 7 + n + m + n * m
    assert (sections, axis) == (1, 4)
    assert crc == zlib.crc32(struct.pack(f"<{count - 2}I", *words[2:]))
    values = np.array(words[7:], dtype=np.uint32).view(np.int32)
    return values[:n], values[n : n + m], values[n + m :].reshape(n, m)


def made(
    places: list[float],
    currents: list[float],
    forces: list[list[float]],
    axis: Axis = VELOCITY,
) -> Monotone:
    """A check's result: forces in the direction of the motion, rising where they do."""
    steady = SteadyForces(np.array(places), np.array(currents), np.array(forces), axis)
    limits = np.full(len(places), currents[-1])
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
        (made([-1e-10, 1e-10], [0.0, 1.0], BOTH, STROKE), "whole nm"),
        (made([-0.1, 1.08], [0.0, 1.0], BOTH, STROKE), "pass 1.073 m"),
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


def elastomer() -> Monotone:
    damper, simulate = simulator_of_file(root() / "sim_hil/data/dampers/mre_2014.toml")
    return monotone_range(damper, 2.0, simulate=simulate, axis=STROKE)


def test_map_of_a_spring_goes_over_its_stroke() -> None:
    words = map_words(elastomer())
    assert words[3:7] == [1, 3, 8, MAX_CURRENTS]
    (one,) = maps_of_words(words)
    assert one.axis == STROKE
    assert one.places == pytest.approx([-5e-4, -1.5e-4, -5e-5, -1.5e-5, 1.5e-5, 5e-5, 1.5e-4, 5e-4])
    i = one.currents_A[None, :]
    stiffness_N_m = (1.080 + 0.7649 * i - 0.1391 * i**2) * 1e6 * 9.36e-4 / 0.003
    # Between two currents of the check's 31 the force is a straight line.
    assert one.forces_N == pytest.approx(stiffness_N_m * one.places[:, None], rel=5e-4, abs=1e-3)


def test_over_velocity_the_spring_has_no_such_map() -> None:
    damper, simulate = simulator_of_file(root() / "sim_hil/data/dampers/mre_2014.toml")
    with pytest.raises(UsageError, match="no stroke or no speed"):
        monotone_range(damper, 2.0, simulate=simulate)


def test_maps_of_several_dampers_become_one() -> None:
    first, second = map_words(monotone_range(dissipative_tanh(), 2.0)), map_words(elastomer())
    both = joined([first, second])
    assert both[3] == 2 and both[4:] == first[4:] + second[4:]
    damped, sprung = maps_of_words(both)
    assert (damped.axis, sprung.axis) == (VELOCITY, STROKE)
    assert maps_of_words(joined([both, first]))[2].currents_A[-1] == 2.0
    for tables, why in (
        ([both, both, first], "5 dampers; a map is of 1 .. 4"),
        ([first, [1, *first[1:]]], "a map with 0x32464d51"),
    ):
        with pytest.raises(ValueError, match=why):
            joined(tables)


def test_what_a_controller_cannot_hold_is_refused() -> None:
    speeds = [float(v) for v in np.linspace(-0.31, 0.32, MAX_PLACES)]
    currents = [float(i) for i in np.linspace(0.0, 1.0, MAX_CURRENTS)]
    forces = [[10.0 + 10.0 * i for i in currents] for _ in speeds]
    large = map_words(made(speeds, currents, forces))
    with pytest.raises(ValueError, match="2256 words, 9024 bytes; a controller takes 2048 words"):
        joined([large, large, large, large])


def test_command_joins_maps(tmp_path: Path, capsys) -> None:
    for name, damper, options in (
        ("a", "rd1005_kwok_tanh_smooth", ["--max-current-A", "1.5"]),
        ("b", "mre_2014", ["--over", "stroke"]),
    ):
        file = str(ROOT / f"sim_hil/data/dampers/{damper}.toml")
        assert main(["identify", "inverse", file, *options, "--out", str(tmp_path / name)]) == 0
    told = capsys.readouterr().out
    assert "where the motion turns" in told and "at every stroke" in told
    files = [str(tmp_path / f"{name}/map.table") for name in "ab"]
    assert main(["identify", "inverse", *files, "--out", str(tmp_path / "both")]) == 0
    told = capsys.readouterr().out
    assert "damper 1: over velocity, 0 .. 1.5 A\ndamper 2: over stroke, 0 .. 2 A\n" in told
    assert len(maps_of_words(read_words(tmp_path / "both/map.table"))) == 2


@pytest.mark.parametrize(
    ("options", "why"),
    [
        ([], "made one with --out"),
        (["--json", "--out", "x"], "no other option"),
        (["--method", "ffn", "--out", "x"], "no other option"),
        (["--out", "x"], "a.table: not a table file"),
    ],
)
def test_command_joins_nothing_else(options: list[str], why: str, tmp_path: Path, capsys) -> None:
    file = tmp_path / "a.table"
    file.write_text("0xzz\n", encoding="utf-8")
    assert main(["identify", "inverse", str(file), *options]) == 2
    assert why in capsys.readouterr().err
