"""Cases of `./tools/benchmark unseen --part rank`, its regret, and what it says without data."""

import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from quiesce.base.errors import BenchFailure
from quiesce.damper.candidates import Choice
from quiesce.damper.data.folds import CURRENT, MOTION, Fold
from quiesce.damper.data.record import Record
from quiesce.damper.identify import identify
from quiesce.damper.task import Plan
from quiesce_benchmarks.part import Effort
from quiesce_benchmarks.unseen import judged_cases
from quiesce_benchmarks.unseen.cases import DAMPERS, QUICK, Case, cases_of
from quiesce_benchmarks.unseen.measured import entries
from quiesce_benchmarks.unseen.parts import rank, speed


def sine(current_A: float, freq_Hz: float, size_m: float) -> Record:
    time_s = np.arange(400) / 100.0
    omega = 2.0 * np.pi * freq_Hz
    disp_m, velocity_m_s = size_m * np.sin(omega * time_s), size_m * omega * np.cos(omega * time_s)
    command = np.full(400, current_A)
    return Record(
        "made",
        100.0,
        time_s,
        disp_m,
        velocity_m_s,
        -(omega**2) * disp_m,
        velocity_m_s,
        command,
        "A",
    )


MADE = [sine(level, *motion) for motion in ((1.0, 8e-3), (3.0, 2e-3)) for level in (0, 0.5, 1, 2)]


def test_each_inner_current_and_each_motion_is_a_case() -> None:
    found = list(cases_of("made", MADE))
    assert [one.name for one in found] == [
        f"made without {text}" for text in ("0.5 A", "1 A", "2 mm at 3 Hz", "8 mm at 1 Hz")
    ]
    assert len(list(cases_of("made", MADE, 1))) == 2
    assert not list(cases_of("made", MADE[:1]))


def test_a_case_is_fitted_without_its_held_out_test_and_judged_on_it(build) -> None:
    """Two viscous models of a viscous damper: whichever is chosen, little is lost."""
    case = next(iter(cases_of("made", MADE)))
    plan = Plan(["bingham", "nonlinear_biviscous"], Choice(rig=()), quick=True, jobs=1)
    fitted = identify(case.held.fit, case.held.validation, plan)
    found = rank.judged(case, fitted)
    assert {found.chosen, found.best} <= {"bingham", "nonlinear_biviscous"}
    assert found.best_error <= found.chosen_error < 0.05 and found.regret_pct >= 0.0
    assert 0.0 <= found.coverage <= 1.0


def case_of(kind: str) -> Case:
    return Case("made", Fold(kind, kind, [], []))


def test_every_damper_of_the_cases_is_a_file_that_is_read() -> None:
    names = {one["name"] for one in entries()}
    assert set(QUICK) <= set(DAMPERS)
    assert {name for files in DAMPERS.values() for name in files} <= names


def test_regret_is_over_the_best_on_the_held_out_test() -> None:
    same = rank.Judged(case_of(CURRENT), "a", "a", 0.1, 0.1, 0.96)
    far = replace(same, case=case_of(MOTION), best="b", best_error=0.08, coverage=1.0)
    found = rank.measured([same, far])
    assert found.values["rank_regret_mean_pct"] == pytest.approx(12.5)
    assert found.values["rank_regret_worst_pct"] == pytest.approx(25.0)
    assert found.values["interval_coverage_pct"] == pytest.approx(98.0)
    assert found.values["interval_coverage_over_99_pct"] == 0.0
    assert "made without motion" in found.tables[0]


def test_bands_that_hold_everything_are_too_wide() -> None:
    wide = rank.Judged(case_of(CURRENT), "a", "a", 0.1, 0.1, 1.0)
    assert rank.measured([wide]).values["interval_coverage_over_99_pct"] == pytest.approx(1.0)
    without = rank.measured([replace(wide, coverage=None)]).values
    assert without["interval_coverage_pct"] is without["interval_coverage_over_99_pct"] is None


def test_without_measurements_it_says_where_they_should_be(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(rank, "data_folder", lambda: None)
    with pytest.raises(BenchFailure, match="no measurements at"):
        rank.measure(Effort(1, True, tmp_path))


def test_a_case_is_judged_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A run that was stopped goes on; another seed's cases are its own."""
    monkeypatch.setattr(judged_cases, "build_folder", lambda: tmp_path / "build")
    monkeypatch.setattr(rank, "data_folder", lambda: tmp_path / "data")
    monkeypatch.setattr(rank, "all_cases", lambda *_: [case_of(CURRENT), case_of(MOTION)])
    asked = []

    def identified(fit, _validation, plan: Plan):
        asked.append((fit, plan.seed))
        if len(asked) == 2:
            raise KeyboardInterrupt
        return []

    monkeypatch.setattr(rank, "identify", identified)
    monkeypatch.setattr(
        rank, "judged", lambda case, _fitted: rank.Judged(case, "a", "b", 0.2, 0.1, 0.95)
    )
    with pytest.raises(KeyboardInterrupt):
        rank.measure(Effort(1, True, tmp_path))
    assert rank.measure(Effort(1, True, tmp_path)).values["rank_regret_worst_pct"] == 100.0
    assert len(asked) == 3
    rank.measure(Effort(1, True, tmp_path))
    assert len(asked) == 3
    rank.measure(Effort(2, True, tmp_path))
    assert [seed for _, seed in asked[3:]] == [2, 2]


def test_a_judged_case_that_is_damaged_or_anothers_is_none(tmp_path: Path) -> None:
    kept = judged_cases.JudgedCases(tmp_path)
    assert kept.get("one") is None
    kept.put("one", {"chosen": "a"})
    assert kept.get("one") == {"chosen": "a"} and kept.get("two") is None
    file = next(tmp_path.iterdir())
    file.write_text(file.read_text().replace("one", "two"))
    assert kept.get("one") is None
    file.write_text("{")
    assert kept.get("one") is None


def test_command_that_fails_is_told_with_its_last_line(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(speed.sys, "path", sys.path)
    with pytest.raises(BenchFailure, match="no model 'nothing'"):
        speed.took(["identify", "none.csv", "--model", "nothing"])
