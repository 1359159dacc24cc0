"""What the part `tones` of `./tools/benchmark lock` plays, and what it counts."""

import numpy as np
import pytest
from quiesce.signal.resample import resample
from quiesce_benchmarks.lock.parts.tones import Told, least_pct, starts_of
from quiesce_benchmarks.lock.waves import (
    KINDS,
    LINE_RATE_Hz,
    Wave,
    is_another,
    made_up,
    strongest,
)
from quiesce_benchmarks.signal.records import make_rig


def told(group: str, updates: int, valid: int, right: int = 0) -> Told:
    return Told(group, "", updates, valid, right)


def test_strongest_is_the_component_with_most_energy() -> None:
    time_s = np.arange(250) / LINE_RATE_Hz
    first = 2.0 * np.cos(2.0 * np.pi * 7.3 * time_s + 0.4)
    second = 1.0 * np.cos(2.0 * np.pi * 17.9 * time_s)
    freqs_Hz, shares, levels = strongest(np.array([first, 9.8 + first + second]))
    assert freqs_Hz == pytest.approx([7.3, 7.3], abs=0.01)
    assert shares == pytest.approx([1.0, 0.8], abs=0.01)
    assert levels == pytest.approx([2.0, 2.0], rel=0.01)


@pytest.mark.parametrize(
    ("other_Hz", "expected"), [(7.1, False), (9.0, True), (2.1, False), (18.3, False), (25.0, True)]
)
def test_neither_a_beat_nor_a_harmonic_is_another_line(other_Hz: float, expected: bool) -> None:
    assert is_another(6.2, np.array([other_Hz]))[0] == expected


def test_what_surrounds_a_made_up_tone_is_as_far_below_as_asked() -> None:
    below_dB = 14.0
    waves = list(made_up(1000, 8.0, 2 * len(KINDS), 3, (below_dB, below_dB)))
    for number, wave in enumerate(waves):
        lines = resample(wave.accel_m_s2, 1000, LINE_RATE_Hz)[None, 20:-20]
        kind = KINDS[number % len(KINDS)]
        freqs_Hz, shares, _ = strongest(lines)
        assert wave.name.startswith(f"{freqs_Hz[0]:.2f}"[:-1])
        assert kind in wave.name
        found_dB = -10.0 * np.log10(1.0 / shares[0] - 1.0)
        # Of a drift slower than the record the mean takes a part away.
        assert found_dB > below_dB - 1.5
        assert found_dB < below_dB + (8.0 if kind == "slow drift" else 1.5)


def test_groups_are_means_over_records_and_the_least_of_them_counts() -> None:
    records = [told("a", 100, 100), told("a", 10, 5), told("b", 20, 14)]
    assert least_pct(records, lambda one: one.valid / one.updates) == pytest.approx(70.0)
    assert least_pct(records[:2], lambda one: one.valid / one.updates) == pytest.approx(75.0)


def test_noise_has_no_start_and_a_tone_is_trusted_after_one() -> None:
    rig = make_rig([])
    rng = np.random.default_rng(5)
    noise = Wave("", "noise", rng.standard_normal(4000))
    assert starts_of(rig, noise) == []
    tone = np.cos(2.0 * np.pi * 11.0 * np.arange(4000) / rig.rate_Hz)
    starts = starts_of(rig, Wave("", "tone", 9.8 + tone))
    assert len(starts) == 6
    assert all(one.freq_Hz == pytest.approx(11.0, abs=0.01) for one in starts)
    assert all(0.1 < one.wait_s < 1.3 for one in starts)
    # What is played and what is judged must be the same stretch: half of it is another tone.
    later = np.cos(2.0 * np.pi * 23.0 * np.arange(4000) / rig.rate_Hz)
    (last, *_) = reversed(starts_of(rig, Wave("", "two", np.concatenate([tone, later]))))
    assert last.freq_Hz == pytest.approx(23.0, abs=0.01) and last.wait_s < 1.3
