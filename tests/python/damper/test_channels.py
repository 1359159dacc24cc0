"""Faults planted into the channels of measured files are told; the files themselves are not."""

import math
from collections.abc import Iterator
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from damper_files import ROOT, samples, text_of
from quiesce.damper.data.channels import cycles_of, falling_force, suspicions
from quiesce.damper.data.read import RawTest
from quiesce.damper.data.record import Record
from quiesce_benchmarks.unseen.measured import measured_tests
from quiesce_benchmarks.unseen.planted import (
    NOISE,
    drifting,
    exported,
    planted,
    stuck,
    with_channel,
)

MEASURED = ROOT.parent / "shared/data"


@cache
def raw_tests() -> list[RawTest]:
    if not (MEASURED / "mr_damper").is_dir():
        pytest.skip(f"{MEASURED / 'mr_damper'} is not on this machine")
    return measured_tests(MEASURED)


def cycle_of(test: RawTest) -> float:
    motion = test.si.get("displacement", np.cumsum(test.si.get("velocity", np.zeros(1))))
    cycle = cycles_of(motion)
    assert cycle is not None
    return float(np.median(cycle))


def some() -> Iterator[RawTest]:
    """One test of each file and current level: enough for a kind of fault."""
    yield from raw_tests()[:: max(1, len(raw_tests()) // 12)]


def test_measured_files_are_beyond_suspicion() -> None:
    found = {test.where: suspicions(test) for test in raw_tests()}
    assert len(found) >= 50
    assert {where: texts for where, texts in found.items() if texts} == {}


def test_noise_and_filters_raise_no_suspicion() -> None:
    for test in some():
        for noise in (0.0, NOISE):
            assert suspicions(exported(test, cycle_of(test), noise, 1)) == [], test.where


def test_saturated_and_stuck_channels_are_found_behind_noise_and_filter() -> None:
    count = 0
    for test in some():
        if "displacement" in test.si and "dyke" not in test.where:
            for one in planted(test, cycle_of(test), 1):
                texts = suspicions(one.test)
                assert any(one.word in text for text in texts), (test.where, one.name, texts)
                count += 1
    assert count >= 50


def test_saturated_force_of_a_random_motion_is_told_where_the_file_is_as_measured() -> None:
    """Its peaks are too short to be told behind a filter."""
    test = next(test for test in raw_tests() if "dyke" in test.where)
    force_N = test.si["force"]
    limited = with_channel(test, "force", np.clip(force_N, -0.5 * np.ptp(force_N), 900.0))
    (text,) = suspicions(limited)
    assert "the force stays at 900 N, exactly its upper end" in text


def test_where_a_channel_is_stuck_is_told() -> None:
    test = next(test for test in raw_tests() if "sine_5mm3hz" in test.where)
    (text,) = suspicions(stuck(test, "displacement", cycle_of(test)))
    first_s = float(text.split("from ")[1].split(" to ")[0])
    assert first_s == pytest.approx(float(test.time_s[-1]) - 0.5, abs=0.03)


def test_drifting_force_is_told() -> None:
    for test in (test for test in raw_tests() if "sine_5mm3hz" in test.where):
        assert any("mean drifts by" in text for text in suspicions(drifting(test)))


def test_late_velocity_is_told() -> None:
    test = next(test for test in raw_tests() if "velocity" in test.si and "freq_hz=1 " in test.name)
    late = with_channel(test, "velocity", np.roll(test.si["velocity"], 8))
    (text,) = suspicions(late)
    assert "comes 0.04 s later" in text


def made(force_N: np.ndarray, angle: np.ndarray, disp_m: np.ndarray) -> RawTest:
    time_s = angle / (2.0 * math.pi)
    si = {"displacement": disp_m, "force": force_N}
    return RawTest("made", "made.csv:2", 0.005, 0.0, time_s, si, 0.0)


def test_constant_speed_and_a_dwell_are_no_faults() -> None:
    """A triangular motion has a flat force; where the motion rests the force falls to zero."""
    angle = np.arange(2000) * 2.0 * math.pi * 0.005
    triangle = 2.0 / math.pi * np.arcsin(np.sin(angle))
    speed = np.sign(np.cos(angle)) + np.random.default_rng(1).normal(0.0, 0.003, len(angle))
    assert suspicions(made(300.0 * speed, angle, 5e-3 * triangle)) == []
    rests = np.clip(1.4 * np.sin(angle), -1.0, 1.0)
    moving = np.abs(1.4 * np.sin(angle)) < 1.0
    force_N = (200.0 * speed + 100.0 * np.cos(angle)) * moving
    assert suspicions(made(force_N, angle, 5e-3 * rests)) == []


def test_interchanged_commands_are_told() -> None:
    records = []
    for level, size in ((0.0, 1.0), (1.0, 5.0)):
        angle = np.arange(400) * 0.1
        force_N, zero = 100.0 * size * np.cos(angle), np.zeros(400)
        motion = (np.sin(angle), np.cos(angle), -np.sin(angle))
        records.append(Record(f"{level:g}.csv", 100.0, angle, *motion, force_N, zero + level, "A"))
    assert falling_force(records) is None
    low, high = records
    swapped = [replace(low, command=high.command), replace(high, command=low.command)]
    text = falling_force(swapped)
    assert text is not None and "are the commands interchanged?" in text


def test_interchanged_force_and_displacement_are_named_as_a_cause(tmp_path, capsys) -> None:
    from quiesce.cli.main import main

    rows = [(row[0], row[2] / 60.0, 60.0 * row[1], row[3]) for row in samples()]
    (tmp_path / "rig.csv").write_text(text_of(rows), encoding="utf-8")
    assert main(["identify", str(tmp_path / "rig.csv"), "--out", str(tmp_path / "out")]) == 2
    assert "force and displacement are interchanged" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()
