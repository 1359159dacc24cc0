"""Figures of a comparison, beside numbers that are known another way."""

import numpy as np
import pytest
from quiesce.compare.figures import INDEXED, columns, figures_of, index, zone_of
from quiesce.compare.weighting import velocity_rms_mm_s, vibration_dose, weighted, wk

# Magnitudes of Wk in thirds of an octave, ISO 2631-1, table 3.
WK = {0.5: 0.418, 1.0: 0.482, 2.0: 0.531, 4.0: 0.967, 8.0: 1.036, 16.0: 0.768, 31.5: 0.405,
      63.0: 0.186}  # fmt: skip
RATE_Hz = 1000.0


@pytest.mark.parametrize(("freq_Hz", "factor"), WK.items())
def test_weighting_is_the_standard_s(freq_Hz: float, factor: float) -> None:
    assert abs(wk(np.array([freq_Hz]))[0]) == pytest.approx(factor, rel=0.01)


def test_a_weighted_sine_has_its_factor_and_dose() -> None:
    t = np.arange(0, 20, 1 / RATE_Hz)
    felt = weighted(2.0 * np.sin(2 * np.pi * 8.0 * t), RATE_Hz)[5000:]
    assert np.sqrt(np.mean(felt**2)) == pytest.approx(2.0 / np.sqrt(2) * 1.036, rel=0.01)
    # The mean of a sine's fourth power is 3/8.
    assert vibration_dose(felt, RATE_Hz) == pytest.approx(
        2.0 * 1.036 * (3 / 8 * len(felt) / RATE_Hz) ** 0.25, rel=0.01
    )


def test_velocity_is_that_of_a_sine_in_its_band() -> None:
    t = np.arange(0, 10, 1 / RATE_Hz)
    w = 2 * np.pi * 25.0
    inside = 1e-3 * w * np.sin(w * t)  # 1 mm/s
    below = 5.0 * np.sin(2 * np.pi * 2.0 * t)
    assert velocity_rms_mm_s(inside + below, RATE_Hz) == pytest.approx(1 / np.sqrt(2), rel=1e-3)
    found = [zone_of({"velocity_rms_mm_s": v}) for v in (0.1, 1.4, 2.9, 4.5)]
    assert found == ["A", "B", "C", "D"]


def trace() -> dict[str, np.ndarray]:
    t = np.arange(0, 4, 1 / RATE_Hz)
    sine = np.sin(2 * np.pi * 2.0 * t)
    return {
        "t_s": t,
        "low_true_um": 1000.0 * sine,
        "low_true_mm_s2": 300.0 * sine,
        "high_true_um": -500.0 * sine,
        "high_true_mm_s2": 900.0 * sine,
        "d_true_stroke_um": 1000.0 * sine,
        # 40 N against the motion: a full cycle of 1 mm takes 4 x 40 x 1e-3 J.
        "d_true_force_mN": 4e4 * np.sign(np.cos(2 * np.pi * 2.0 * t)),
        "d_true_mA": np.full(len(t), 250.0),
        "d_current_cmd_mA": np.where(np.arange(len(t)) % 2 == 0, 200.0, 300.0),
    }


def test_figures_of_a_known_motion() -> None:
    motion = trace()
    assert set(columns(["low", "high"], ["d"])) == set(motion)
    found = figures_of(motion, ["low", "high"], ["d"])
    expected = {
        "disp_peak_mm": 0.5, "disp_rms_mm": 0.5 / np.sqrt(2), "drift_peak_mm": 1.5,
        "drift_rms_mm": 1.5 / np.sqrt(2), "accel_peak_m_s2": 0.9, "force_peak_N": 40.0,
        "current_mean_A": 0.25, "current_rms_A": 0.25, "dissipated_J": 8 * 0.16,
        "chatter_A_s": 100.0,
    }  # fmt: skip
    for name, value in expected.items():
        assert found[name] == pytest.approx(value, rel=0.01), name


def test_index_is_the_mean_of_six_ratios() -> None:
    base = figures_of(trace(), ["low", "high"], ["d"])
    half = {name: 0.5 * value for name, value in base.items()}
    assert index(base, base) == pytest.approx(1.0)
    assert index(half, base) == pytest.approx(0.5)
    assert index({**base, INDEXED[0]: 7 * base[INDEXED[0]]}, base) == pytest.approx(2.0)
