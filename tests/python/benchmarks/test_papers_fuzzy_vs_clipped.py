"""Clipped optimal control and a fuzzy law on the frame: what each does, and the part that compares
them."""

from pathlib import Path

import numpy as np
import pytest
from quiesce_benchmarks.papers import frame_laws
from quiesce_benchmarks.papers.frame_laws import MAX_A, Observer, clipped_optimal, fuzzy, shaken
from quiesce_benchmarks.papers.parts import fuzzy_vs_clipped
from quiesce_benchmarks.part import Effort


@pytest.fixture
def frame(tmp_path: Path):
    return frame_laws.frame(tmp_path)


def test_both_laws_beat_no_current(frame):
    quake = frame_laws.earthquake(np.random.default_rng(1))
    laws = {
        "off": fuzzy_vs_clipped.no_current,
        "clipped": clipped_optimal(frame, 4.0, -3.0, -4.0),
        "fuzzy": fuzzy(frame, -1.3, -1.0, 1.0, 0.3, 0.1),
    }
    found = {
        name: shaken(frame, law, quake, np.random.default_rng(2)) for name, law in laws.items()
    }
    for name in ("clipped", "fuzzy"):
        assert found[name].peak_drift_m < 0.7 * found["off"].peak_drift_m
        assert found[name].peak_accel_m_s2 < 0.8 * found["off"].peak_accel_m_s2
        assert 0.05 * MAX_A < found[name].mean_A < 0.95 * MAX_A


def test_clipped_gives_current_towards_the_wanted_force_only(frame):
    law = clipped_optimal(frame, 4.0, -3.0, -4.0)
    state = np.array([0.0, 0.0, 0.0, 0.1, 0.1, 0.1])
    assert law(state, 0.1) == MAX_A  # resists, and too little
    assert law(state, 1e6) == 0.0  # too much
    assert law(state, -0.1) == 0.0  # the other way


def test_fuzzy_is_symmetric_and_within_its_limits(frame):
    law = fuzzy(frame, -1.0, -1.0, 0.9, 0.2, 0.1)
    rng = np.random.default_rng(3)
    for state in rng.normal(scale=0.2, size=(50, 6)):
        assert 0.0 <= law(state, 0.0) <= MAX_A
        assert law(state, 0.0) == pytest.approx(law(-state, 0.0))
    assert law(np.full(6, 1.0), 0.0) == pytest.approx(0.9 * MAX_A)
    assert law(np.zeros(6), 0.0) == pytest.approx(0.09 * MAX_A)


def test_the_observer_follows_the_frame(frame):
    """From the true measurements of a shaken frame, the first storey's speed."""
    quake = frame_laws.earthquake(np.random.default_rng(4))
    motion, observer = frame_laws.Run(frame.plant, frame_laws.TICK_RATE_HZ), Observer(frame)
    errors, speeds = [], []
    for base in quake:
        now = motion.now
        state = observer.update(now.accel_m_s2, now.stroke_m, now.damper_force_N)
        errors.append(state[3] - now.stroke_velocity_m_s)
        speeds.append(now.stroke_velocity_m_s)
        motion.advance(0.5, base_accel_m_s2=base)
    assert np.sqrt(np.mean(np.square(errors))) < 0.2 * np.sqrt(np.mean(np.square(speeds)))


@pytest.mark.slow  # tunes four laws
def test_the_part_judges_on_other_earthquakes(tmp_path: Path):
    found = fuzzy_vs_clipped.measure(Effort(1, True, tmp_path))
    assert 0.3 < found.values["fuzzy_over_clipped"] < 3.0
    assert found.reported["earthquakes"] == 4
    for one in found.reported["laws"]:
        assert one["mean_current_part"] > 0.02  # it acts
        assert np.mean(one["peaks"]) < 1.0
