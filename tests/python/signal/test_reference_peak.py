"""The float64 frequency estimate that the firmware is judged by."""

import numpy as np
import pytest
from quiesce.signal.reference_peak import compare, reference_freq_Hz


@pytest.mark.parametrize("freq_Hz", [1.7, 5.03, 10.1, 15.5, 33.3])
def test_reference_of_a_sine_is_its_frequency(freq_Hz) -> None:
    time_s = np.arange(600) / 100.0
    _, got_Hz = reference_freq_Hz(0.2 + np.sin(2 * np.pi * freq_Hz * time_s), 100.0)
    assert np.abs(got_Hz - freq_Hz).max() < 0.01


def test_reference_describes_the_middle_of_its_window() -> None:
    time_s = np.arange(4000) / 100.0
    sweep = np.sin(2 * np.pi * (5.0 * time_s + 0.5 * 0.06 * time_s**2))
    middle_s, got_Hz = reference_freq_Hz(sweep, 100.0)
    assert np.abs(got_Hz - (5.0 + 0.06 * middle_s)).max() < 0.01


def test_reference_of_a_short_recording_is_empty() -> None:
    assert reference_freq_Hz(np.zeros(199), 100.0)[0].size == 0


def test_compare_counts_valid_updates_inside_the_reference() -> None:
    agreement = compare(
        described_s=np.array([0.0, 1.0, 2.0, 3.0, 9.0]),
        freq_Hz=np.array([5.0, 5.1, 5.3, 50.0, 5.0]),
        is_valid=np.array([True, True, True, False, True]),
        reference_s=np.array([0.5, 4.0]),
        reference_Hz=np.array([5.0, 5.0]),
        tolerance_Hz=0.12,
        from_s=0.0,
        to_s=9.0,
    )
    assert (agreement.updates, agreement.valid, agreement.within) == (3, 2, 1)
    assert agreement.worst_Hz == pytest.approx(0.3)
    assert agreement.within_pct == 50.0
