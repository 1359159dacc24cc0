"""Sensor dynamics, modes and the elastomer of the papers: quick runs of their parts."""

from pathlib import Path

import numpy as np
import pytest
from quiesce_benchmarks.papers import elastomer_mount, modes_beam, parts
from quiesce_benchmarks.papers.parts import modes
from quiesce_benchmarks.part import Effort, Measured, all_parts


def measured(name: str, folder: Path) -> Measured:
    part = all_parts(parts)[name]
    found = part.measure(Effort(1, True, folder))
    assert set(found.values) == {figure[0] for figure in part.FIGURES}
    assert all(table for table in found.tables)
    return found


def test_a_stated_corner_is_taken_back(tmp_path) -> None:
    found = measured("sensors", tmp_path).values
    assert found["sensor_ideal_5Hz_pct"] > 14.0
    assert abs(found["sensor_stated_loss_5Hz_pt"]) < 0.5
    assert found["sensor_unstated_5Hz_pct"] < found["sensor_stated_5Hz_pct"] - 1.0


def test_modes_are_the_published_ones_and_the_second_is_negative_at_the_tip(tmp_path) -> None:
    found = measured("modes", tmp_path)
    assert found.values["mode1_freq_diff_pct"] < 1.0
    assert found.values["mode2_freq_diff_pct"] < 1.0
    assert found.values["mode_orthogonality_printed"] > 0.5
    assert found.values["mode_orthogonality_corrected"] < 0.1
    assert found.reported["mac_corrected"] > 0.98 > found.reported["mac_printed"]
    assert found.reported["band_Hz"] == pytest.approx(modes.BANDWIDTH_Hz, rel=0.02)


def test_the_beam_alone_is_a_textbooks_cantilever(monkeypatch) -> None:
    """Without its disc: f = 3.516, 22.03 / (2 pi L^2) sqrt(E I / (rho A))."""
    monkeypatch.setattr(modes_beam, "DISC_RADIUS_m", 0.0)
    freqs_Hz, shapes = modes_beam.modes(5, 2)
    speed = np.sqrt(modes_beam.MODULUS_Pa / modes_beam.DENSITY_kg_m3 / 12.0)
    unit_Hz = speed * modes_beam.THICKNESS_m / (2.0 * np.pi * modes_beam.LENGTH_m**2)
    assert freqs_Hz / unit_Hz == pytest.approx([3.516, 22.03], rel=1e-3)
    assert (shapes[:, 0] > 0.0).all() and shapes[-1, 1] < 0.0


@pytest.mark.slow
def test_the_elastomer_is_the_published_one(tmp_path) -> None:
    found = measured("elastomer", tmp_path)
    assert found.values["elastomer_area_diff_pct"] < 0.1
    assert found.values["elastomer_stiffness_diff_pct"] < 0.1
    assert found.values["elastomer_bode_diff_pct"] < 0.1
    assert 1.0 < found.values["elastomer_one_setting_diff_pct"] < 10.0
    assert found.reported["most_A"] == pytest.approx(1.78, abs=0.01)
    assert (tmp_path / "elastomer_bode.svg").stat().st_size > 1000


def test_a_mass_on_a_lossy_spring_peaks_at_its_natural_frequency() -> None:
    mount = elastomer_mount.Bode(5.0 * (2.0 * np.pi * 40.0) ** 2, 0.2)
    freqs_Hz = np.linspace(39.0, 41.0, 2001)
    assert mount.natural_Hz == pytest.approx(40.0)
    assert freqs_Hz[np.abs(mount.receptance_m_N(freqs_Hz)).argmax()] == pytest.approx(40.0)
    assert np.abs(mount.transmissibility(np.array([0.01])))[0] == pytest.approx(1.0, abs=1e-6)
