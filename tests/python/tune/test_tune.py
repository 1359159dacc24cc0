"""`quiesce tune`: end to end on a plant of one mode, interrupted, with bad input; and its parts."""

import json
import math
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
import tomli_w
from conftest import ROOT, run_quiesce
from quiesce.base.errors import UsageError
from quiesce.cli.main import main
from quiesce.engine.bench import Bench
from quiesce.optimum.goal import reference
from quiesce.optimum.periodic import drive
from quiesce.plant.library import Plant
from quiesce.plant.variant import read_plant_data
from quiesce.tune.cycle import cycle_of
from quiesce.tune.law import parameters
from quiesce.tune.phase_table import read_law
from quiesce.tune.plan import Band, chosen_settings, frequencies, variants
from quiesce.tune.pulse import Pulse, best_pulse
from quiesce.tune.robust import sine_text
from quiesce.tune.setting import Marks
from quiesce.tune.store import TuneStore

pytestmark = pytest.mark.slow  # optimal control takes its time

PUBLISHED = ROOT / "sim_hil/data/plants/squeeze_2012.toml"
SHORT = ("--quick", "--from-Hz", "8", "--to-Hz", "16", "--step-Hz", "8")
ALONE = ("--robustness", "none", "--no-closed-loop")


def write_one_mode(folder: Path) -> Path:
    """The published plant without its second mode."""
    data = read_plant_data(PUBLISHED)
    data["name"] = "one mode"
    data["structure"]["mode"] = data["structure"]["mode"][:1]
    file = folder / "one_mode.toml"
    file.write_text(tomli_w.dumps(data), encoding="utf-8")
    return file


def write_viscous(folder: Path) -> Path:
    """One mode and a linear damper, which is quick to compute."""
    data = read_plant_data(write_one_mode(folder))
    data["damper"] = {
        "model": "viscous", "base_N_s_m": 0.0, "per_A_N_s_m": 0.15, "stroke_m": 0.002
    }  # fmt: skip
    file = folder / "viscous.toml"
    file.write_text(tomli_w.dumps(data), encoding="utf-8")
    return file


@pytest.fixture
def one_mode(tmp_path: Path) -> Path:
    return write_one_mode(tmp_path)


@pytest.fixture(scope="module")
def tuned(build, tmp_path_factory) -> tuple[Path, dict]:
    """A finished tuning: its folder, and what --json printed."""
    folder = tmp_path_factory.mktemp("tune")
    result = run_quiesce(
        folder, "tune", write_one_mode(folder), *SHORT, "--out", "out", "--json", "--jobs", "2"
    )
    assert result.returncode == 0, result.stderr
    return folder / "out", json.loads(result.stdout)


def test_all_files_are_written(tuned) -> None:
    folder, data = tuned
    expected = {"one_mode.phase.toml", "one_mode.phase.table", "one_mode.set", "report.html"}
    assert expected <= set(data["files"])
    assert all((folder / name).stat().st_size > 0 for name in data["files"])
    page = (folder / "report.html").read_text(encoding="utf-8")
    assert page.count("<figure") == 5
    assert "--set unlock_current_mA=5000" in page


def test_law_has_the_frequencies_and_stays_near_the_bound(tuned) -> None:
    folder, data = tuned
    law = read_law(folder / "one_mode.phase.toml")
    assert [point.freq_Hz for point in law.settings["displacement"]] == [8.0, 16.0]
    assert law.source.startswith("quiesce tune") and "--step-Hz 8" in law.source
    assert "--out" not in law.source
    assert all(0.3 < p.accel_shape < 3.0 for points in law.settings.values() for p in points)
    for row in (one for one in data["frequencies"] if not one["is_between"]):
        bound_pct = row["bounds"]["amp"]["amp_red_pct"]
        assert 0.88 * bound_pct < row["settings"]["displacement"]["amp_red_pct"] <= bound_pct
        assert row["settings"]["balanced"]["accel_red_pct"] > -1.0
        assert bound_pct >= row["constants"][-1]["amp_red_pct"]


def test_adapting_firmware_does_about_what_the_table_promises(tuned) -> None:
    nominal = [one for one in tuned[1]["robustness"] if one["variant"] == "nominal"]
    assert {one["freq_Hz"] for one in nominal} == {8.0, 16.0}
    for cell in nominal:
        table, adapted = cell["table"]["displacement"], cell["adapted"]["displacement"]
        assert adapted["amp_red_pct"] == pytest.approx(table["amp_red_pct"], abs=2.0)
        assert adapted["amp_red_pct"] <= cell["bound"]["amp_red_pct"]


def test_pulses_act_like_a_spring_below_resonance_and_a_mass_above(tuned) -> None:
    below, above = tuned[1]["cycles"]
    assert below["freq_Hz"] == 8.0 and below["stiffness_N_m"] > 10.0
    assert above["freq_Hz"] == 16.0 and above["stiffness_N_m"] < -10.0
    assert below["damping_N_s_m"] > 0.0 and above["damping_N_s_m"] > 0.0


def run_bench(folder: Path, table: Path) -> dict:
    scenario = folder / "scenario.toml"
    scenario.write_text(sine_text(write_one_mode(folder), 8.0, 8.0), encoding="utf-8")
    options = ("--set", "adapt=off", "--set", "phase_setting=displacement")
    words = ("--scenario", str(scenario), "--law", "phase", "--pulses", str(table), *options)
    return Bench().json("run", *words)


def test_bench_takes_the_words_and_does_what_the_table_promises(tuned, tmp_path: Path) -> None:
    folder, data = tuned
    row = data["frequencies"][0]
    figures = run_bench(tmp_path, folder / "one_mode.phase.table")
    reduction_pct = 100.0 * (1.0 - figures["amp_um"] / data_amp_um(folder))
    promised_pct = row["settings"]["displacement"]["amp_red_pct"]
    assert reduction_pct == pytest.approx(promised_pct, abs=0.7)


def data_amp_um(folder: Path) -> float:
    pieces = json.loads((folder / "work.json").read_text())["pieces"]
    return pieces["bound 8 Hz"]["uncontrolled"]["amp_um"]


@pytest.mark.parametrize(
    "damage",
    [
        lambda words: words[:-4],
        lambda words: words[:-1],
        lambda words: b"",
        lambda words: bytes([words[0] ^ 1]) + words[1:],
        lambda words: words[:-8] + bytes([words[-8] ^ 1]) + words[-7:],
    ],
    ids=["a word short", "a byte short", "empty", "magic", "a bit"],
)
def test_bench_refuses_damaged_words(tuned, tmp_path: Path, damage) -> None:
    table = tmp_path / "law.table"
    table.write_bytes(damage((tuned[0] / "one_mode.phase.table").read_bytes()))
    with pytest.raises(UsageError, match="law.table"):
        run_bench(tmp_path, table)


def test_same_command_again_computes_nothing(tuned) -> None:
    folder, data = tuned
    before = (folder / "work.json").read_bytes()
    again = run_quiesce(folder.parent, "tune", "one_mode.toml", *SHORT, *ALONE, "--out", "out")
    assert again.returncode == 0, again.stderr
    assert "Hz  (" not in again.stderr
    assert (folder / "work.json").read_bytes() == before


def test_interrupted_run_keeps_what_is_finished_and_goes_on(build, tmp_path: Path) -> None:
    folder = tmp_path
    band = ("--quick", "--from-Hz", "14", "--to-Hz", "22", "--step-Hz", "8")
    words = ("tune", write_viscous(folder).name, *band, *ALONE, "--out", "out", "--jobs", "2")
    store = folder / "out/work.json"
    process = subprocess.Popen(
        [sys.executable, "-m", "quiesce", *words],
        cwd=folder,
        env={**os.environ, "PYTHONPATH": str(ROOT / "tools/src")},
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )
    while not store.exists() and process.poll() is None:
        time.sleep(0.02)
    os.killpg(process.pid, signal.SIGINT)
    err = process.communicate()[1]
    assert process.returncode == 130, err
    assert [line for line in err.splitlines() if not line.startswith("[")] == [
        "quiesce: interrupted; the same command goes on with the pieces that are finished"
    ]
    kept = json.loads(store.read_text())["pieces"]
    assert kept
    again = run_quiesce(folder, *words)
    assert again.returncode == 0, again.stderr
    pieces = json.loads(store.read_text())["pieces"]
    assert len(pieces) == 8
    assert again.stderr.count("Hz  (") == 8 - len(kept)
    assert {key: pieces[key] for key in kept} == kept


def test_recording_is_identified_once_and_tuned_for(build, tmp_path: Path) -> None:
    plant = write_viscous(tmp_path).name
    record = ("--band", "4", "30", "--sweep-s", "10", "--dwell-hz", "9", "--hold-s", "0.3")
    rest = ("--rest-s", "1.5", "--max-current", "5", "--out", "rec.csv")
    assert run_quiesce(tmp_path, "sweep", "--simulate", plant, *record, *rest).returncode == 0
    words = ("tune", "--from-sweep", "rec.csv", "--base-plant", plant, *SHORT, *ALONE)
    first = run_quiesce(tmp_path, *words, "--out", "out", "--json")
    assert first.returncode == 0, first.stderr
    assert "least squares" in first.stderr
    data = json.loads(first.stdout)
    assert "95 % interval" in data["identification"]
    assert "95 % interval" in (tmp_path / "out/report.html").read_text(encoding="utf-8")
    assert Plant(tmp_path / "out/identified/plant.toml").modes[0].freq_Hz == pytest.approx(
        11.5, abs=0.01
    )
    assert len(read_law(tmp_path / "out/rec.phase.toml").settings["balanced"]) == 2
    again = run_quiesce(tmp_path, *words, "--out", "out")
    assert again.returncode == 0, again.stderr
    assert "least squares" not in again.stderr and "Hz  (" not in again.stderr


def small_store(folder: Path, **inputs) -> TuneStore:
    return TuneStore(folder, {"plant": "a", "settings": {"x": math.inf}, **inputs}, False)


def test_store_gives_back_what_it_got(tmp_path: Path) -> None:
    store = small_store(tmp_path)
    store.put("5 Hz", {"bound": 19.5})
    with pytest.raises(UsageError, match="another run works there"):
        small_store(tmp_path)
    store.close()
    again = small_store(tmp_path)
    assert "5 Hz" in again and again["5 Hz"] == {"bound": 19.5}


@pytest.mark.parametrize(
    ("damage", "word"),
    [
        (lambda text: text[:40], "damaged"),
        (lambda text: text.replace("19.5", "29.5"), "checksum"),
        (lambda text: "[]", "schema"),
        (lambda text: text.replace('"plant": "a"', '"plant": "b"'), "another plant"),
    ],
)
def test_store_that_is_damaged_or_of_other_inputs_is_refused(tmp_path: Path, damage, word) -> None:
    store = small_store(tmp_path)
    store.put("5 Hz", {"bound": 19.5})
    store.close()
    store.file.write_text(damage(store.file.read_text()))
    with pytest.raises(UsageError, match=word):
        small_store(tmp_path)
    assert len(TuneStore(tmp_path, {"plant": "a"}, is_fresh=True)) == 0


def test_other_weights_use_the_bounds_again(tuned) -> None:
    folder = tuned[0]
    before = json.loads((folder / "work.json").read_text())["pieces"]
    words = ("--weights", "balanced=1,0,0.3", *SHORT, *ALONE, "--out", "out", "--json")
    result = run_quiesce(folder.parent, "tune", "one_mode.toml", *words)
    assert result.returncode == 0, result.stderr
    assert result.stderr.count("Hz  (") == 2 and "bound" not in result.stderr
    after = json.loads((folder / "work.json").read_text())["pieces"]
    assert {key: after[key] for key in before} == before
    used_A = [row["settings"]["balanced"]["mean_current_A"] for row in frequencies_of(result)]
    usual_A = [row["settings"]["balanced"]["mean_current_A"] for row in tuned[1]["frequencies"]]
    assert all(used < usual for used, usual in zip(used_A[::2], usual_A[::2], strict=True))


def frequencies_of(result) -> list[dict]:
    return json.loads(result.stdout)["frequencies"]


def test_other_quality_is_not_mixed_with_what_is_stored(tuned) -> None:
    folder = tuned[0]
    before = (folder / "work.json").read_bytes()
    words = (*(word for word in SHORT if word != "--quick"), *ALONE, "--out", "out")
    result = run_quiesce(folder.parent, "tune", "one_mode.toml", *words)
    assert result.returncode == 2
    assert "another quality" in result.stderr and "--fresh" in result.stderr
    assert (folder / "work.json").read_bytes() == before


@pytest.mark.parametrize(
    ("words", "part"),
    [
        ((), "name a plant file"),
        (("one_mode.toml", "--from-sweep", "a.csv"), "one of them"),
        (("--from-sweep", "no.csv"), "no.csv"),
        (("one_mode.toml", "--modes", "2"), "go with --from-sweep"),
        (("no.toml",), "no.toml"),
        (("one_mode.toml", "--from-Hz", "20", "--to-Hz", "10"), "must be lower"),
        (("one_mode.toml", "--from-Hz", "0.1"), "--from-Hz 0.1"),
        (("one_mode.toml", "--step-Hz", "0.1"), "a table has 2 to 64"),
        (("one_mode.toml", "--step-Hz", "-1"), "--step-Hz -1"),
        (("one_mode.toml", "--from-Hz", "nan"), "--from-Hz: expected a number, found 'nan'"),
        (("one_mode.toml", "--weights", "best=1,1,1"), "no setting 'best'"),
        (("one_mode.toml", "--weights", "balanced=1,1"), "DISPLACEMENT,ACCELERATION,CURRENT"),
        (("one_mode.toml", "--weights", "balanced=0,0,1"), "not both"),
        (("one_mode.toml", "--weights", "balanced=-1,2,0"), "0 or more"),
        (("one_mode.toml", "--accel-limit", "balanced=x"), "balanced=PERCENT"),
        (("one_mode.toml", "--jobs", "0"), "--jobs"),
        (("one_mode.toml", "--out", "one_mode.toml"), "is a file"),
        (("broken.toml",), "gap_m"),
        (("strong.toml",), "at most 20 A"),
    ],
)
def test_bad_input_is_refused_in_one_line(
    build, one_mode: Path, monkeypatch, capsys, words, part
) -> None:
    monkeypatch.chdir(one_mode.parent)
    text = one_mode.read_text()
    Path("broken.toml").write_text(text.replace("gap_m = 0.002", "gap_m = -1"))
    Path("strong.toml").write_text(text.replace("max_current_A = 5.0", "max_current_A = 25.0"))
    before = sorted(one_mode.parent.rglob("*"))
    assert main(["tune", *words]) == 2
    out, err = capsys.readouterr()
    assert out == "" and len(err.splitlines()) == 1 and part in err
    assert sorted(one_mode.parent.rglob("*")) == before


def test_command_refuses_in_one_line(refused, one_mode: Path) -> None:
    message = refused("tune", one_mode, "--from-Hz", "20", "--to-Hz", "10")
    assert "--from-Hz 20 --to-Hz 10" in message


def test_band_follows_the_first_mode(build) -> None:
    plant = Plant(PUBLISHED)
    usual = frequencies(plant, Band(), is_quick=False)
    assert (usual[0], usual[-1], len(usual)) == (4.0, 23.0, 39)
    quick = frequencies(plant, Band(), is_quick=True)
    assert quick[0] == 5.0 and quick[-1] >= 23.0 and 5 <= len(quick) <= 7


def test_variants_change_one_property_or_all(build) -> None:
    plant = Plant(PUBLISHED)
    assert [len(variants(plant, kind)) for kind in ("none", "axes", "full")] == [0, 9, 81]
    names = {variant.name for variant in variants(plant, "axes")}
    assert {"nominal", "force0.7", "lag10ms", "freq1.1", "drive0.12V"} <= names


def test_own_weights_decide_alone_and_limits_stay() -> None:
    settings = chosen_settings(["balanced=1,0,0.5"], ["balanced=110"])
    goal = settings["balanced"].first(Marks(bound_pct=20.0, constant_pct=10.0))
    assert (goal.amp, goal.accel, goal.current) == (1.0, 0.0, 0.5)
    assert goal.amp_limit == 1.0 and goal.accel_limit == pytest.approx(1.1)


def test_weight_of_the_current_saves_current(build) -> None:
    ref = reference(drive(Plant(PUBLISHED), 15.0))
    first = Pulse(30.0, 140.0, 5.0, 0.0)
    means_A = []
    for weight in ("0", "0.2"):
        setting = chosen_settings([f"displacement=1,0,{weight}"], [])["displacement"]
        goal = setting.first(Marks(0.0, 0.0))
        means_A.append(best_pulse(ref, goal, first)[1].orbit.mean_current_A)
    assert means_A[1] < 0.8 * means_A[0]


def test_cycle_tells_stiffness_and_damping_apart() -> None:
    t_s = np.arange(4000) / 1000.0
    turn = 2.0 * math.pi * 7.3 * t_s
    disp_um = 50.0 * np.cos(turn + 0.4)
    velocity_um_s = -50.0 * 2.0 * math.pi * 7.3 * np.sin(turn + 0.4)
    force_mN = 1e-3 * (-80.0 * disp_um + 2.0 * velocity_um_s) + np.cos(3.0 * turn)
    trace = {"t_s": t_s, "x5_um": disp_um, "coil_A": 0.0 * t_s, "force_mN": force_mN}
    cycle = cycle_of(trace, 7.3, "balanced", 60.0, side=1.0)
    assert cycle.stiffness_N_m == pytest.approx(-80.0, rel=1e-6)
    assert cycle.damping_N_s_m == pytest.approx(2.0, rel=1e-6)
    assert np.all(np.diff(cycle.turn_deg) > 0.0)
    assert cycle.disp_um[0] == pytest.approx(50.0, rel=0.01)


def test_parameters_follow_decay_and_current(tuned) -> None:
    folder, data = tuned
    mode = Plant(PUBLISHED).modes[0]
    decay_ms = 1e3 / (mode.damping_ratio * 2.0 * math.pi * mode.freq_Hz)
    values = parameters(Plant(PUBLISHED), read_law(folder / "one_mode.phase.toml"))
    assert values["adapt_settle_ms"] == pytest.approx(3.0 * decay_ms, abs=10.0)
    assert values == data["parameters"]
    written = (folder / "one_mode.set").read_text().split()
    assert written[::2] == ["--set"] * (len(written) // 2)
