"""Mass and skew of a rig: planted ones are found, implausible ones are named and left out."""

import threading
from pathlib import Path

import numpy as np
import pytest
from quiesce.cli.main import main
from quiesce.damper import library
from quiesce.damper.candidates import Choice, parametric_candidates, setting_of
from quiesce.damper.data.record import Record
from quiesce.damper.data.split import Segment, whole
from quiesce.damper.fit.rig_terms import MASS, SKEW, tells_mass
from quiesce.damper.fit_model import RigFit
from quiesce.damper.task import Plan

TRUTH = {
    "c_N_s_m": 900.0, "k_N_m": 2000.0, "kw_N": 300.0, "rho_1_m": 1500.0, "sigma": 0.8, "n": 1.5,
    "f0_N": 12.0,
}  # fmt: skip
RATE_Hz = 200.0
ANY = Choice()


def recorded(
    freqs_Hz: tuple[float, ...], mass_kg: float = 0.0, skew_s: float = 0.0, noise_N: float = 3.0
) -> Segment:
    """A normalised Bouc-Wen damper under sines of 4 mm at 1 Hz, less above, 8 s, with a rig."""
    time_s = np.arange(round(8.0 * RATE_Hz)) / RATE_Hz
    omega = 2.0 * np.pi * np.array(freqs_Hz)[:, None]
    angle, size_m = omega * time_s, 4e-3 / np.array(freqs_Hz)[:, None]
    disp_m = np.sum(size_m * np.sin(angle), axis=0)
    velocity_m_s = np.sum(size_m * omega * np.cos(angle), axis=0)
    accel_m_s2 = -np.sum(size_m * omega**2 * np.sin(angle), axis=0)
    zero = np.zeros(len(time_s))
    record = Record("made", RATE_Hz, time_s, disp_m, velocity_m_s, accel_m_s2, zero, zero, "A")
    rig = [{"inertia_kg": mass_kg, "skew_s": skew_s}.get(name, 0.0) for name in library.RIG]
    row = np.array([*TRUTH.values(), *rig])
    model = library.model("normalised_bouc_wen")
    force_N = library.simulate(model, [1] * len(TRUTH), row, library.motion(record), 4)[0]
    force_N += np.random.default_rng(1).normal(0.0, noise_N, len(force_N))
    return whole(
        Record("made", RATE_Hz, time_s, disp_m, velocity_m_s, accel_m_s2, force_N, zero, "A")
    )


def fitted(
    segment: Segment, name: str = "normalised_bouc_wen", choice: Choice = ANY
) -> tuple[dict[str, float], list[str]]:
    candidate = parametric_candidates()[name]
    plan = Plan([name], choice, quick=True, stop=threading.Event())
    fit = RigFit(candidate, [segment], plan, None, 300.0, lambda *_: None)
    problem, found, notes = fit.with_rig(setting_of(candidate, [segment], choice))
    names = [one.name for one in problem.variables]
    return dict(zip(names, map(float, found.values), strict=True)), notes


def test_planted_mass_and_skew_are_found() -> None:
    values, notes = fitted(recorded((1.0, 3.1, 7.3), mass_kg=2.0, skew_s=1.5e-3))
    assert values[MASS] == pytest.approx(2.0, rel=0.2)
    assert values[SKEW] == pytest.approx(1.5e-3, rel=0.2)
    assert notes == []


def test_nothing_is_found_where_nothing_is() -> None:
    values, notes = fitted(recorded((1.0, 3.1, 7.3)))
    assert not {MASS, SKEW} & set(values) and notes == []


def test_mass_is_not_told_from_stiffness_at_one_frequency() -> None:
    one, many = recorded((2.0,), mass_kg=4.0), recorded((1.0, 3.1), mass_kg=4.0)
    assert not tells_mass([one]) and tells_mass([many])
    assert MASS not in fitted(one)[0]


@pytest.mark.slow
def test_implausible_mass_is_named_and_left_out() -> None:
    """60 kg at a force of 430 N: they weigh more than a tenth of it."""
    segment = recorded((1.0, 3.1, 7.3), mass_kg=60.0)
    values, notes = fitted(segment)
    assert not {MASS, SKEW} & set(values)
    assert any("moving mass left out" in note and "--rig-mass-kg" in note for note in notes)
    stated, notes = fitted(segment, choice=Choice(bounds={MASS: (0.0, 100.0)}))
    assert stated[MASS] == pytest.approx(60.0, rel=0.2) and notes == []


def test_mass_that_is_known_stays() -> None:
    values, _ = fitted(recorded((2.0,), mass_kg=4.0), choice=Choice(bounds={MASS: (3.0, 5.0)}))
    assert 3.0 <= values[MASS] <= 5.0


@pytest.mark.parametrize("text", ["5", "3:2", "-1:2", "a:b", "1:inf"])
def test_bad_mass_ends_in_one_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], text: str
) -> None:
    (tmp_path / "rig.csv").write_text("t_s,x_mm,force_N\n", encoding="utf-8")
    words = ["identify", str(tmp_path / "rig.csv"), f"--rig-mass-kg={text}"]
    assert main([*words, "--out", str(tmp_path / "out")]) == 2
    said = capsys.readouterr().err.strip()
    assert "write LOW:HIGH in kg" in said and "\n" not in said
    assert not (tmp_path / "out").exists()
