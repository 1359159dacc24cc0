"""`quiesce sweep`: the excitation, a simulated recording, and the refusal of bad recordings."""

from pathlib import Path

import numpy as np
import pytest
from conftest import ROOT
from quiesce.base.errors import UsageError
from quiesce.plant_id.recording import read_sweep_recording
from quiesce.plant_id.sweep import HELD_FRACTIONS, SweepPlan, dwell_currents, timeline

PLANT = ROOT / "sim_hil/data/plants/squeeze_2012.toml"
SHORT = ("--sweep-s", "6", "--dwell-hz", "10", "--hold-s", "0.2", "--rest-s", "0.5")


def read_csv(file: Path) -> tuple[list[str], np.ndarray]:
    head, *rows = file.read_text().splitlines()
    return head.split(","), np.array([[float(cell) for cell in row.split(",")] for row in rows])


def spectrum_peak_Hz(values: np.ndarray, rate_Hz: float) -> float:
    return float(np.argmax(np.abs(np.fft.rfft(values)))) * rate_Hz / len(values)


@pytest.mark.parametrize("is_linear", [False, True])
def test_sweep_part_covers_its_band(is_linear: bool) -> None:
    plan = SweepPlan(is_linear=is_linear, low_Hz=4.0, high_Hz=80.0, sweep_s=20.0)
    line = timeline(plan)
    start = round(plan.rest_s * plan.rate_Hz)
    slope_Hz = np.diff(line.phase_cycles[start : start + 20000]) * plan.rate_Hz
    assert slope_Hz[0] == pytest.approx(4.0, rel=1e-3)
    assert slope_Hz[-1] == pytest.approx(80.0, rel=1e-3)
    middle_Hz = 42.0 if is_linear else np.sqrt(4.0 * 80.0)
    assert slope_Hz[10000] == pytest.approx(middle_Hz, rel=1e-2)


def test_sweep_has_no_current_and_dwells_reach_every_level() -> None:
    plan = SweepPlan(max_current_A=2.0)
    line = timeline(plan)
    sweep_end = round((2.0 * plan.rest_s + plan.sweep_s) * plan.rate_Hz)
    assert np.all(line.current_A[:sweep_end] == 0.0)
    assert set(line.current_A) == {2.0 * part for part in HELD_FRACTIONS}
    assert np.all(line.current_A[line.amplitude_V == 0.0] == 0.0)


def test_dwell_ends_with_jumps_between_none_and_all() -> None:
    plan = SweepPlan()
    jumps = np.abs(np.diff(dwell_currents(plan)))
    assert np.count_nonzero(jumps == plan.max_current_A) >= 8


def test_dwell_has_its_frequency() -> None:
    plan = SweepPlan(dwell_Hz=(7.0,), rest_s=1.0)
    line = timeline(plan)
    start = round((2.0 * plan.rest_s + plan.sweep_s) * plan.rate_Hz)
    drive_V = line.drive_V[start : start + 8000]
    assert spectrum_peak_Hz(drive_V, plan.rate_Hz) == pytest.approx(7.0)
    assert np.abs(drive_V).max() == pytest.approx(plan.dwell_drive_V, rel=1e-6)


@pytest.mark.parametrize(
    ("changes", "word"),
    [
        ({"low_Hz": 20.0, "high_Hz": 10.0}, "--band"),
        ({"rate_Hz": 500}, "--rate 500"),
        ({"sweep_s": 1.0}, "--sweep-s"),
        ({"drive_V": 0.0}, "--drive"),
        ({"dwell_Hz": (-1.0,)}, "--dwell-hz"),
        ({"max_current_A": 0.0}, "--max-current"),
        ({"hold_s": 0.0}, "--hold-s"),
        ({"sweep_s": 1e7}, "rows"),
    ],
)
def test_plan_that_cannot_be_recorded_is_refused(changes, word) -> None:
    with pytest.raises(UsageError, match=word):
        SweepPlan(**changes)


@pytest.mark.slow
def test_excitation_is_written_without_acceleration(quiesce, tmp_path: Path) -> None:
    result = quiesce("sweep", *SHORT, "--out", "folder/excitation.csv")
    assert result.returncode == 0, result.stderr
    head, rows = read_csv(tmp_path / "folder/excitation.csv")
    assert head == ["time_s", "drive_V", "current_cmd_A"]
    assert np.diff(rows[:, 0]) == pytest.approx(0.001, abs=1e-9)
    assert (tmp_path / "folder/excitation.png").stat().st_size > 1000
    assert "quiesce sweep --identify" in result.stdout


@pytest.mark.slow
def test_simulated_recording_depends_on_the_seed_alone(quiesce, tmp_path: Path) -> None:
    for name, seed in (("a", 3), ("b", 3), ("c", 4)):
        out = f"{name}.csv"
        result = quiesce("sweep", *SHORT, "--simulate", PLANT, "--seed", str(seed), "--out", out)
        assert result.returncode == 0, result.stderr
    texts = [(tmp_path / f"{name}.csv").read_text() for name in "abc"]
    assert texts[0] == texts[1] != texts[2]
    head, rows = read_csv(tmp_path / "a.csv")
    assert head[3] == "accel_m_s2"
    rest = rows[:500, 3]
    assert rest.std() == pytest.approx(0.5e-3 * 9.80665, rel=0.15)
    count_m_s2 = 49.4 * 9.80665 / 2**23
    counts = rows[:, 3] / count_m_s2
    assert np.abs(counts - np.rint(counts)).max() < 1e-3


@pytest.mark.parametrize(
    ("arguments", "word"),
    [
        (("--band", "9", "3"), "--band"),
        (("--dwell-hz", "5", "--first-mode", "5"), "exclude"),
        (("--simulate", "none.toml"), "none.toml"),
        (("--identify", "none.csv"), "none.csv"),
        (("--identify", "none.csv", "--modal-mass", "0"), "--modal-mass"),
        (("--identify", "a.csv", "--simulate", "b.toml"), "not allowed"),
        (("--out", "."), "folder"),
    ],
)
def test_bad_arguments_are_refused(refused, arguments, word) -> None:
    assert word in refused("sweep", *arguments)


# Recordings that cannot be identified from.


def rows_of(plan: SweepPlan) -> list[str]:
    line = timeline(plan)
    accel = np.gradient(line.drive_V) + 1e-3 * np.random.default_rng(1).standard_normal(
        len(line.drive_V)
    )
    columns = (line.time_s, line.drive_V, line.current_A, accel)
    rows = [",".join(f"{value:.9g}" for value in row) for row in zip(*columns, strict=True)]
    return ["time_s,drive_V,current_cmd_A,accel_m_s2", *rows]


PLAN = SweepPlan(
    rate_Hz=400, low_Hz=3.0, high_Hz=40.0, sweep_s=6.0, dwell_Hz=(8.0,), hold_s=0.3, rest_s=0.6
)
GOOD = rows_of(PLAN)


def changed_cell(line: int, column: int, text: str) -> list[str]:
    cells = GOOD[line - 1].split(",")
    cells[column] = text
    return [*GOOD[: line - 1], ",".join(cells), *GOOD[line:]]


def every_cell(column: int, text: str) -> list[str]:
    rows = [row.split(",") for row in GOOD]
    for cells in rows[1:]:
        cells[column] = text
    return [",".join(cells) for cells in rows]


@pytest.mark.parametrize(
    ("rows", "words"),
    [
        ([], ["empty"]),
        ([GOOD[0].replace("accel_m_s2", "acc"), *GOOD[1:]], ["no column 'accel_m_s2'"]),
        (changed_cell(50, 3, "nan"), [":50:", "accel_m_s2", "cut these rows"]),
        (changed_cell(50, 1, "high"), [":50:", "drive_V", "not a number"]),
        (changed_cell(50, 2, "-1"), [":50:", "current_cmd_A", "expected 0 or more"]),
        (changed_cell(700, 2, "1"), [":700:", "0 A"]),
        (GOOD[:300] + GOOD[340:], [":301:", "irregular"]),
        (changed_cell(60, 0, "0"), [":60:", "goes back"]),
        (every_cell(1, "0"), ["drive_V", "0 throughout"]),
        (every_cell(3, "0.5"), ["accel_m_s2", "never changes"]),
        ([GOOD[0], *GOOD[245:2600]], ["no rest"]),
        ([GOOD[0], *GOOD[2660:]], ["no drive sweep"]),
    ],
)
def test_recording_is_refused(tmp_path: Path, rows, words) -> None:
    file = tmp_path / "recording.csv"
    file.write_text("".join(row + "\n" for row in rows))
    with pytest.raises(UsageError) as refusal:
        read_sweep_recording(file)
    for word in ["recording.csv", *words]:
        assert word in str(refusal.value)


def test_command_refuses_a_recording_in_one_line(refused, tmp_path: Path) -> None:
    file = tmp_path / "recording.csv"
    file.write_text("\n".join(changed_cell(50, 3, "")) + "\n")
    message = refused("sweep", "--identify", file, "--out", "out")
    assert "recording.csv:50: column 'accel_m_s2': an empty cell" in message


def test_rate_that_is_no_whole_number_is_refused(tmp_path: Path) -> None:
    file = tmp_path / "recording.csv"
    rows = [row.split(",") for row in GOOD[1:]]
    stretched = [",".join([f"{float(row[0]) * 1.0007:.9g}", *row[1:]]) for row in rows]
    file.write_text("\n".join([GOOD[0], *stretched]) + "\n")
    with pytest.raises(UsageError, match="whole number of Hz"):
        read_sweep_recording(file)
