"""`quiesce hil` on a rig: bodies and dampers by name, on the host and on the image."""

import dataclasses
import json
import shutil
from pathlib import Path

import pytest
from conftest import ROOT, require, run_quiesce
from quiesce.base.errors import UsageError
from quiesce.engine import laws, scenarios
from quiesce.engine.bench import Bench
from quiesce.hil.rig import by_window, rig_rows
from quiesce.hil.runs import Plan, Run

RIG = ROOT / "sim_hil/data/rigs/two_storeys.toml"
LAWS = ["--law", "phase", "--law", "fuzzy_selftune_printed"]


@pytest.fixture(scope="module")
def own(build: Path, tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, str]:
    """The rig's three files in a user's folder, run there: the folder and what was printed."""
    folder = tmp_path_factory.mktemp("mine")
    data = RIG.parents[1]
    shutil.copy(data / "plants/two_storeys.toml", folder / "plant.toml")
    shutil.copy(data / "boards/two_storeys.toml", folder / "board.toml")
    text = RIG.read_text().replace("../plants/two_storeys", "plant")
    (folder / "mine.toml").write_text(text.replace("../boards/two_storeys", "board"))
    options = ["--scenario", "mine.toml", "--target", "host", "--quick", *LAWS, "--out", "report"]
    result = run_quiesce(folder, "hil", *options)
    assert result.returncode == 0, result.stderr
    return folder, result.stdout


@pytest.fixture(scope="module")
def metrics(own: tuple[Path, str]) -> dict:
    return json.loads((own[0] / "report/metrics.json").read_text())


def test_table_has_bodies_and_dampers(own: tuple[Path, str]) -> None:
    text = own[1]
    assert max(len(line) for line in text.splitlines()) <= 110
    for words in ("two_storeys, 8 .. 10 s", "two_storeys, 18 .. 20 s", "mean A", "peak N"):
        assert words in text
    assert "publ." not in text
    for part in ("floor", "roof", "lower", "upper"):
        lines = [line for line in text.splitlines() if line.startswith(part)]
        assert len(lines) == 2 * 3, part  # windows, laws


def test_figures_are_the_bench_s_and_against_law_off(own, metrics: dict) -> None:
    details = json.loads((own[0] / "report/details.json").read_text())
    found = {run["law"]: run["rig"] for run in details["runs"]}
    assert len(metrics["rigs"]) == 2 * 3
    for row in metrics["rigs"]:
        window = 0 if row["start_s"] == 8.0 else 1
        ours, off = found[row["law"]][window], found["open_loop"][window]
        for name, body in row["bodies"].items():
            rms_um, off_um = (part["bodies"][name]["disp_rms_um"] for part in (ours, off))
            assert body["disp_rms_um"] == pytest.approx(rms_um, abs=1e-3)
            expected = 100.0 * (1.0 - rms_um / off_um)
            assert body["disp_rms_um_reduction_pct"] == pytest.approx(expected, abs=1e-3)
            assert body["peak_disp_um"] == pytest.approx(
                ours["bodies"][name]["peak_disp_um"], abs=1e-3
            )
        for name, damper in row["dampers"].items():
            peak_N, off_N = (part["dampers"][name]["peak_force_N"] for part in (ours, off))
            assert damper["peak_force_more_N"] == pytest.approx(peak_N - off_N, abs=1e-3)
    best = [row for row in metrics["rigs"] if row["law"] == "phase"]
    assert all(row["bodies"]["roof"]["disp_rms_um_reduction_pct"] > 50.0 for row in best)
    assert all(row["dampers"]["upper"]["mean_current_A"] > 0.5 for row in best)


def test_page_shows_them(own: tuple[Path, str]) -> None:
    page = (own[0] / "report/index.html").read_text(encoding="utf-8")
    assert "<h2>Bodies and dampers</h2>" in page and "The end of two_storeys" in page
    assert "<h2>Comparison</h2>" not in page
    assert page.count(">roof<") == 2 * 3


@pytest.mark.slow
def test_image_for_boards_answers_like_the_host(build: Path, image: Path, tmp_path: Path) -> None:
    require(image.with_name("quiesce_mps2_shm_8x4.elf"))
    options = ["--scenario", RIG, "--law", "phase", "--quick", "--target", "mps2", "--json"]
    on_host = run_quiesce(tmp_path, "hil", *options[:-2], "host", "--json", "--out", "a")
    on_image = run_quiesce(tmp_path, "hil", *options, "--out", "b")
    assert on_image.returncode == 0, on_image.stderr
    rows = [json.loads(result.stdout)["rigs"] for result in (on_host, on_image)]
    assert {row["target"] for row in rows[1]} == {"mps2"}
    assert [{**row, "target": ""} for row in rows[0]] == [{**row, "target": ""} for row in rows[1]]
    equal = json.loads((tmp_path / "b/metrics.json").read_text())["trace_equal"]
    assert equal["mismatches"] == 0 and equal["distinct_commands"] > 100


@pytest.mark.slow
def test_linux_controller_answers_like_the_host(build: Path, tmp_path: Path) -> None:
    require(build / "host/targets/linux/quiesced/quiesced")
    options = ["--scenario", RIG, "--law", "fuzzy", "--quick", "--target", "linux"]
    result = run_quiesce(tmp_path, "hil", *options, "--out", "a")
    assert result.returncode == 0, result.stdout + result.stderr
    metrics = json.loads((tmp_path / "a/metrics.json").read_text())
    assert metrics["trace_equal"]["mismatches"] == 0
    assert {row["target"] for row in metrics["rigs"]} == {"host", "linux"}


@pytest.fixture(scope="module")
def scenario(build: Path) -> scenarios.Scenario:
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("QUIESCE_BUILD", str(build))
        return scenarios.load(Bench(), str(RIG))


def plan_of(scenario: scenarios.Scenario) -> Plan:
    return Plan([scenario], [scenario.name], [*laws.LAWS], ["host"], False)


def test_law_that_lacks_a_signal_is_left_out_by_its_name(scenario: scenarios.Scenario) -> None:
    lacks = {**scenario.board.lacks, "phase": "force of upper"}
    poor = dataclasses.replace(scenario, board=dataclasses.replace(scenario.board, lacks=lacks))
    assert [case.law.bench_law for case in plan_of(scenario).cases()].count("phase") == 2
    assert plan_of(scenario).left_out() == []
    assert "phase" not in [case.law.bench_law for case in plan_of(poor).cases()]
    assert plan_of(poor).left_out() == [
        f"two_storeys: {law} is left out, it needs force of upper, which no sensor of board "
        "two_storeys provides"
        for law in ("phase", "phase_displacement")
    ]


def test_each_window_is_against_law_off_of_the_same_target(scenario: scenarios.Scenario) -> None:
    def run(law: str, target: str, rms_um: float) -> Run:
        body = {"disp_rms_um": rms_um, "peak_disp_um": 2.0, "accel_rms_mm_s2": 0.0}
        damper = {"mean_current_A": 0.0, "peak_force_N": rms_um, "peak_stroke_um": 1.0}
        window = {"start_s": 1.0, "end_s": 2.0, "bodies": {"b": body}, "dampers": {"d": damper}}
        case = type("Case", (), {"scenario": scenario, "law": laws.find(law), "target": target})
        return Run(case, {"rig": [window]}, {})

    runs = [run("open_loop", "host", 8.0), run("open_loop", "mps2", 4.0)]
    rows = rig_rows([*runs, run("fuzzy", "host", 2.0), run("fuzzy", "mps2", 2.0)])
    found = {(row.law, row.target): row for row in rows}
    assert found["fuzzy", "host"].bodies["b"]["disp_rms_um_reduction_pct"] == 75.0
    assert found["fuzzy", "mps2"].bodies["b"]["disp_rms_um_reduction_pct"] == 50.0
    assert found["fuzzy", "mps2"].bodies["b"]["accel_rms_mm_s2_reduction_pct"] is None
    assert found["fuzzy", "host"].dampers["d"]["peak_force_more_N"] == -6.0
    assert [*by_window(rows)] == ["two_storeys, 1 .. 2 s"]


# What is refused


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        ("board.toml", "none.toml", ["none.toml"]),
        ("plant.toml", "none.toml", ["none.toml"]),
    ],
)
def test_missing_file_of_a_rig_is_refused(own, refused, tmp_path, old, new, expected) -> None:
    text = (own[0] / "mine.toml").read_text().replace(old, new)
    for name in ("plant.toml", "board.toml"):
        shutil.copy(own[0] / name, tmp_path)
    (tmp_path / "mine.toml").write_text(text)
    message = refused("hil", "--scenario", "mine.toml", "--target", "host", "--out", "out")
    for words in expected:
        assert words in message


def test_board_that_does_not_fit_the_plant_is_refused(own, refused, tmp_path: Path) -> None:
    for name in ("plant.toml", "mine.toml"):
        shutil.copy(own[0] / name, tmp_path)
    board = (own[0] / "board.toml").read_text()
    (tmp_path / "board.toml").write_text(board.replace("roof", "attic"))
    message = refused("hil", "--scenario", "mine.toml", "--target", "host", "--out", "out")
    assert "'attic' of the board" in message and "floor, roof" in message


@pytest.mark.parametrize(
    ("options", "expected"),
    [
        (["--target", "host", "--noise-mg", "1"], ["--noise-mg", "[noise]"]),
        (["--target", "host", "--set", "accel_polarity=-1"], ["comes from the board file"]),
    ],
)
def test_option_that_does_not_go_with_a_board_is_refused(refused, options, expected) -> None:
    message = refused("hil", "--scenario", RIG, *options)
    for text in expected:
        assert text in message


@pytest.mark.parametrize(
    "words",
    [
        ["tune"],
        ["sweep", "--out", "recording.csv", "--simulate"],
    ],
)
def test_commands_for_one_damper_say_so(refused, words) -> None:
    message = refused(*words, ROOT / "sim_hil/data/plants/two_storeys.toml")
    assert "two_storeys has 2 dampers; this works on plants with one" in message


def test_one_damper_with_a_name_is_refused_by_tune(refused, tmp_path: Path) -> None:
    plant = (ROOT / "sim_hil/data/plants/two_storeys.toml").read_text()
    upper, rest = plant[plant.index('[[damper]]\nname = "upper"') :].split("[driver]")
    (tmp_path / "one.toml").write_text(plant.replace(upper, ""))
    assert rest
    message = refused("tune", "one.toml", "--quick", "--out", "law")
    assert "one.toml: its dampers have names and ends ([[damper]])" in message


def test_record_has_a_column_for_each_sensor(quiesce, tmp_path: Path) -> None:
    result = quiesce("record", RIG, "--from-s", "5", "--to-s", "6", "--out", "rig.csv")
    assert result.returncode == 0, result.stderr
    head, *rows = (tmp_path / "rig.csv").read_text().splitlines()
    assert head == "t_s,floor_accel_m_s2,roof_accel_m_s2,upper_stroke_mm"
    assert len(rows) == 1000 and rows[0].startswith("5,")
    peaks = [max(abs(float(row.split(",")[k])) for row in rows) for k in (1, 2, 3)]
    # At the first mode: the roof moves about 1.62 times as far as the floor.
    assert peaks[1] / peaks[0] == pytest.approx(1.62, rel=0.05)
    assert peaks[2] == pytest.approx(
        1e3 * (peaks[1] - peaks[0]) / (2.0 * 3.14159265 * 3.0) ** 2, rel=0.05
    )


def test_laws_of_the_firmware_have_their_own_names() -> None:
    for label in ("off", "constant", "fuzzy_selftune"):
        assert laws.find(label) == laws.Law(label, label, label)
    with pytest.raises(UsageError, match="no law 'magic'; there are: .*phase.*constant"):
        laws.find("magic")


def test_a_setting_chooses_no_law(build: Path) -> None:
    result = run_quiesce(
        ROOT, "hil", "--scenario", str(RIG), "--target", "host", "--set", "law=off"
    )
    assert result.returncode == 2
    assert result.stderr.strip().endswith("--law NAME chooses them")


@pytest.mark.parametrize(
    ("change", "expected"),
    [
        (("board = ", "noise_mg = 3.0\nboard = "), "[noise] of the plant"),
        (('board = "../boards/two_storeys.toml"', ""), 'board = "FILE" in the scenario'),
    ],
)
def test_what_a_rig_lacks_is_said(
    build: Path, tmp_path: Path, change: tuple[str, str], expected: str
) -> None:
    text = RIG.read_text().replace(*change).replace('"../', f'"{RIG.parents[1]}/')
    (tmp_path / "mine.toml").write_text(text)
    result = run_quiesce(tmp_path, "hil", "--scenario", "mine.toml", "--target", "host", "--quick")
    assert result.returncode == 2
    assert expected in result.stderr
    assert "Traceback" not in result.stderr
