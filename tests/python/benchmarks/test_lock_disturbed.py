"""What the part `disturbed` of `./tools/benchmark lock` makes of its inputs."""

import numpy as np
import pytest
from quiesce_benchmarks.control.scenarios import steady
from quiesce_benchmarks.lock.parts.disturbed import (
    Case,
    DURATION_s,
    Found,
    LAST_s,
    amplitude,
    is_another,
    worst,
)


def found(reduction_pct: float, lock_pct: float) -> Found:
    return Found(Case("", 5.0, steady(5.0, 8.0)), reduction_pct, lock_pct)


def test_amplitude_is_that_of_one_component_at_the_end() -> None:
    time_s = np.arange(0.0, DURATION_s, 0.001)
    early = time_s < DURATION_s - LAST_s - 0.1
    values = 3.0 + 2.0 * np.sin(2.0 * np.pi * 5.0 * time_s + 0.7)
    values += 1.5 * np.sin(2.0 * np.pi * 6.3 * time_s)
    values[early] *= 10.0
    assert amplitude(time_s, values, 5.0) == pytest.approx(2.0, rel=1e-3)
    assert amplitude(time_s, values, 6.3) == pytest.approx(1.5, rel=1e-3)


@pytest.mark.parametrize(
    ("second_Hz", "expected"), [(5.6, False), (6.3, True), (3.7, True), (15.2, False), (16.9, True)]
)
def test_a_beat_or_a_harmonic_is_no_second_tone(second_Hz: float, expected: bool) -> None:
    assert is_another(5.0, second_Hz) == expected


def test_the_worst_share_is_of_what_is_reached_alone() -> None:
    pairs = [
        (found(20.0, 100.0), [found(19.0, 99.0), found(18.0, 100.0)]),
        (found(10.0, 100.0), [found(8.0, 97.0)]),
    ]
    assert worst(pairs) == pytest.approx((97.0, 0.8))
