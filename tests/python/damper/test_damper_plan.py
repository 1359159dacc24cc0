"""The test plan stays within damper and rig, and says what each test is for."""

import csv
import json
import tomllib
from pathlib import Path

import numpy as np
import pytest
from damper_actions import act, refused
from damper_files import read
from quiesce.base.errors import UsageError
from quiesce.cli.identify import plan as cli_plan
from quiesce.damper import sines_and_chirps
from quiesce.damper.excitation import (
    chirp,
    envelope,
    ramps,
    random_motion,
    sine,
    sweep,
    times,
)
from quiesce.damper.plan import (
    KINDS,
    SPEED_PARTS,
    Damper,
    Plan,
    excitation,
    make_plan,
    step_level_A,
)
from scipy.io import loadmat

USUAL = Damper(0.05, 2000.0, 2.0, 0.3, 10.0, 0.9)
DAMPERS = {
    "usual": USUAL,
    "slow rig": Damper(0.2, 2e5, 5.0, 0.5, 1.5, 200.0),
    "small": Damper(0.004, 30.0, 0.3, 0.05, 60.0, 0.05),
    "squeeze": Damper(0.001, 400.0, 3.0, 0.02, 30.0, 0.5),
}
OPTIONS = ("--stroke-mm", "50", "--max-force-N", "2000", "--max-current-A", "2")


@pytest.fixture(params=sorted(DAMPERS))
def plan(request) -> Plan:
    return make_plan(DAMPERS[request.param])


def test_every_test_stays_within_stroke_speed_and_current(plan: Plan) -> None:
    for test in plan.tests:
        found = excitation(plan, test)
        speed = np.gradient(found.disp_m, found.time_s)
        assert np.abs(found.disp_m).max() <= 0.41 * plan.damper.stroke_m
        assert np.abs(speed).max() <= 1.02 * plan.damper.max_speed_m_s, test.name
        assert found.current_A.min() >= 0.0
        assert found.current_A.max() <= plan.damper.max_current_A * (1.0 + 1e-9)


def test_every_test_begins_and_ends_at_rest_in_mid_stroke(plan: Plan) -> None:
    for test in plan.tests:
        found = excitation(plan, test)
        step_s = found.time_s[1]
        largest = np.abs(np.diff(found.disp_m)).max() / step_s
        for end in (0, -1):
            assert abs(found.disp_m[end]) <= 1e-6 * plan.damper.stroke_m
        for ends in (slice(0, 3), slice(-3, None)):
            assert np.abs(np.diff(found.disp_m[ends])).max() / step_s <= 0.06 * largest, test.name


def test_every_kind_of_test_is_there_once_and_explained(plan: Plan) -> None:
    # Chirps belong to the published protocol.
    assert {test.kind for test in plan.tests} == set(KINDS) - {"chirp"}
    assert len({cli_plan.file_name(plan, test, "csv") for test in plan.tests}) == len(plan.tests)
    assert all(test.duration_s > 0.0 and test.pause_s > 0.0 for test in plan.tests)


def test_no_sine_is_faster_than_the_rig(plan: Plan) -> None:
    assert max(test.freq_Hz for test in plan.tests) <= plan.damper.rig_max_Hz


def test_sines_cover_speeds_amplitudes_and_currents() -> None:
    sines = [test for test in make_plan(USUAL).tests if test.kind == "sine"]
    speeds = {round(test.speed_m_s / USUAL.max_speed_m_s, 3) for test in sines}
    assert speeds == set(SPEED_PARTS)
    assert len({test.amplitude_m for test in sines}) == 2
    assert {test.current_A for test in sines} == {0.0, 0.5, 1.0, 1.5, 2.0}


def test_steps_of_the_current_come_at_speed_and_leave_a_plateau() -> None:
    plan = make_plan(USUAL)
    steps = [test for test in plan.tests if test.kind == "steps"]
    assert [step_level_A(USUAL, test) for test in steps] == [1.0, 2.0]
    for test in steps:
        found = excitation(plan, test)
        jumps = np.flatnonzero(np.diff(found.current_A) != 0.0)
        assert len(jumps) >= 8
        assert np.diff(jumps).min() * found.time_s[1] >= 0.3
        speed = np.abs(np.gradient(found.disp_m, found.time_s))
        assert np.median(speed[jumps]) >= 0.8 * test.speed_m_s


def test_plan_is_the_same_every_time() -> None:
    one, other = make_plan(USUAL), make_plan(USUAL)
    for test in one.tests:
        found, again = excitation(one, test), excitation(other, test)
        assert np.array_equal(found.disp_m, again.disp_m)
        assert np.array_equal(found.current_A, again.current_A)


def test_light_damper_is_warned_of_heat_and_slow_rig_of_speed() -> None:
    light = Damper(0.05, 5000.0, 2.0, 0.5, 10.0, 0.3)
    assert any("warm" in line for line in make_plan(light).warnings)
    slow = make_plan(DAMPERS["slow rig"])
    assert not any("the rig reaches" in line for line in slow.warnings)
    assert any("skew" in line for line in slow.warnings)
    short = Damper(0.05, 2000.0, 2.0, 0.3, 1.0, 0.9)
    assert any("the rig reaches" in line for line in make_plan(short).warnings)


def test_rig_far_too_slow_is_refused() -> None:
    with pytest.raises(UsageError, match="raise --rig-max-Hz"):
        make_plan(Damper(0.01, 2000.0, 2.0, 1.0, 1.0, 0.9))


# Shapes


def test_sine_has_its_amplitude_in_the_middle() -> None:
    time_s = times(4.0, 1000.0)
    disp = sine(time_s, 0.01, 2.0)
    assert np.abs(disp).max() == pytest.approx(0.01, rel=1e-3)
    assert envelope(time_s, 0.5)[2000] == 1.0


def test_ramps_run_at_their_speed_in_mid_stroke() -> None:
    time_s = times(20.0, 1000.0)
    disp = ramps(time_s, 0.02, 0.01)
    speed = np.abs(np.gradient(disp, time_s))
    middle = np.abs(disp) < 0.01
    inner = slice(5000, 15000)
    assert speed[inner][middle[inner]] == pytest.approx(0.01, rel=0.02)


def test_sweep_is_slow_and_large_first_then_fast_and_small() -> None:
    time_s = times(20.0, 1000.0)
    disp = sweep(time_s, 0.02, 0.3, 0.5, 20.0)
    assert np.abs(disp[:8000]).max() > 0.015
    assert np.abs(disp[18000:]).max() < 0.006


def test_random_motion_uses_one_of_its_limits() -> None:
    time_s = times(20.0, 1000.0)
    for amplitude, speed in ((0.02, 10.0), (10.0, 0.3)):
        disp = random_motion(time_s, amplitude, speed, (0.3, 5.0), 3)
        reached = (
            np.abs(disp).max() / amplitude,
            np.abs(np.gradient(disp, time_s)).max() / speed,
        )
        assert max(reached) == pytest.approx(0.97, rel=1e-6)


def test_chirp_keeps_its_amplitude_while_its_frequency_rises_evenly() -> None:
    time_s = times(10.0, 500.0)
    disp = chirp(time_s, 5e-3, 1.0, 2.5)
    assert np.abs(disp[1000:4000]).max() == pytest.approx(5e-3, rel=1e-3)
    ups = np.flatnonzero((disp[:-1] < 0.0) & (disp[1:] >= 0.0)) / 500.0
    ups = ups[(ups > 1.0) & (ups < 9.0)]
    middles = 0.5 * (ups[1:] + ups[:-1])
    assert 1.0 / np.diff(ups) == pytest.approx(1.0 + 0.15 * middles, rel=0.02)


def test_published_protocol_is_that_of_the_source() -> None:
    """Table 2: 5 mm, four frequencies, six currents, 5000 samples of 2 ms; chirps of Figs 19-22."""
    plan = sines_and_chirps.make_plan(Damper(0.0125, 2000.0, 1.5, 0.1, 2.5, 0.9))
    sines = {(test.freq_Hz, test.current_A) for test in plan.tests if test.kind == "sine"}
    assert sines == {(f, i) for f in (1.0, 1.5, 2.0, 2.5) for i in (0.0, 0.5, 0.75, 1.0, 1.25, 1.5)}
    chirps = [test for test in plan.tests if test.kind == "chirp"]
    assert [test.current_A for test in chirps] == [0.0, 0.5, 1.0, 1.5]
    assert len(plan.tests) == 28 and plan.rate_Hz == 500.0
    for test in plan.tests:
        found = excitation(plan, test)
        assert len(found.time_s) >= 5000
        assert np.abs(found.disp_m).max() == pytest.approx(5e-3, rel=2e-3)
        assert np.all(found.current_A == test.current_A)


# Command line


def test_command_writes_plan_and_files_that_can_be_read_back(tmp_path: Path, capsys) -> None:
    assert act(cli_plan, *OPTIONS, "--out", tmp_path / "plan") == 0
    said = capsys.readouterr().out
    assert "Needed:" in said and "held out" in said
    with (tmp_path / "plan/plan.csv").open(encoding="utf-8") as stream:
        rows = list(csv.DictReader(stream))
    stated = tomllib.loads((tmp_path / "plan/plan.toml").read_text(encoding="utf-8"))
    assert [row["file"] for row in rows] == [one["file"] for one in stated["tests"]]
    for row in rows:
        head = (tmp_path / "plan" / row["file"]).read_text(encoding="utf-8").splitlines()[0]
        assert head == "time_s,disp_m,current_A"


@pytest.mark.slow
def test_recorded_excitation_is_data_that_identification_takes(tmp_path: Path, capsys) -> None:
    assert act(cli_plan, *OPTIONS, "--out", tmp_path) == 0
    file = next(tmp_path.glob("*sine_20mm_0.716Hz_1A.csv"))
    table = np.loadtxt(file, delimiter=",", skiprows=1)
    speed = np.gradient(table[:, 1], table[:, 0])
    force = 500.0 * np.tanh(40.0 * speed) + 800.0 * speed
    lines = [f"{t:.4f},{x:.7f},{i:g},{f:.3f}" for (t, x, i), f in zip(table, force, strict=True)]
    text = "\n".join(["time_s,disp_m,current_A,force_N", *lines, ""])
    (tmp_path / "recorded.csv").write_text(text, encoding="utf-8")
    record = read(tmp_path / "recorded.csv").records[0]
    assert record.level == 1.0 and len(record) > 5000


def test_command_tells_the_plan_as_json(capsys) -> None:
    assert act(cli_plan, *OPTIONS, "--rig-max-Hz", "5", "--mass-kg", "2", "--json") == 0
    found = json.loads(capsys.readouterr().out)
    assert found["damper"]["mass_kg"] == 2.0 and found["total_s"] > found["recording_s"]
    assert all(test["tells"] for test in found["tests"])


def test_command_takes_the_published_protocol(capsys) -> None:
    assert act(cli_plan, *OPTIONS, "--protocol", "sines-chirps", "--json") == 0
    found = json.loads(capsys.readouterr().out)
    assert [one["kind"] for one in found["tests"]].count("chirp") == 4
    assert "--protocol" in refused(cli_plan, *OPTIONS, "--protocol", "some")


@pytest.mark.parametrize(
    ("changed", "value", "what"),
    [
        ("--stroke-mm", "-50", "a length in mm"),
        ("--stroke-mm", "0", "a length in mm"),
        ("--stroke-mm", "fifty", "a length in mm"),
        ("--max-force-N", "nan", "a force in N"),
        ("--max-force-N", "inf", "a force in N"),
        ("--max-current-A", "-1", "a current in A"),
        ("--rig-max-Hz", "0", "a frequency in Hz"),
        ("--max-speed-m-s", "-0.1", "a speed in m/s"),
        ("--mass-kg", "0", "a mass in kg"),
    ],
)
def test_impossible_numbers_are_refused(changed: str, value: str, what: str) -> None:
    options = dict(zip(OPTIONS[::2], OPTIONS[1::2], strict=True)) | {changed: value}
    words = [word for pair in options.items() for word in pair]
    message = refused(cli_plan, *words)
    assert changed in message and what in message


def test_missing_option_is_named() -> None:
    assert "--max-force-N" in refused(cli_plan, "--stroke-mm", "50", "--max-current-A", "2")


def test_folder_that_cannot_be_written_is_told(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("", encoding="utf-8")
    with pytest.raises((UsageError, OSError)):
        act(cli_plan, *OPTIONS, "--out", tmp_path / "file/plan")


def test_excitations_go_to_other_programs(tmp_path: Path) -> None:
    options = (*OPTIONS, "--protocol", "sines-chirps", "--out")
    assert act(cli_plan, *options, tmp_path / "csv") == 0
    assert act(cli_plan, *options, tmp_path / "mat", "--format", "mat") == 0
    rows = list(csv.DictReader((tmp_path / "mat/plan.csv").open()))
    assert all((tmp_path / "mat" / row["file"]).suffix == ".mat" for row in rows)
    name = rows[0]["file"]
    found = loadmat(tmp_path / "mat" / name, simplify_cells=True)
    text = np.genfromtxt(tmp_path / "csv" / name.replace(".mat", ".csv"), delimiter=",", names=True)
    for column in ("time_s", "disp_m", "current_A"):
        assert found[column] == pytest.approx(text[column], abs=1e-4)
