"""Recordings through the firmware: the shipped one, and measured ones where they are at hand."""

import csv
import json
from pathlib import Path

import numpy as np
import pytest
import pyuff
from conftest import ROOT
from PIL import Image
from scipy.io import loadmat

EXAMPLE = ROOT / "sim_hil/data/recordings/step_10_20Hz.csv"
MEASURED = ROOT.parent / "shared/data/vibration"


def replay(quiesce, file: Path, *options: str) -> dict:
    result = quiesce("replay", file, "--out", "out", "--json", *options)
    assert result.returncode == 0, result.stderr
    return json.loads(result.stdout)


def read_csv(file: Path) -> dict[str, np.ndarray]:
    with file.open() as stream:
        rows = list(csv.reader(stream))
    return dict(zip(rows[0], np.array(rows[1:], dtype=float).T, strict=True))


def measured(name: str) -> Path:
    if not (MEASURED / name).exists():
        pytest.skip(f"{MEASURED / name} is not on this machine")
    return MEASURED / name


# The shipped recording


def test_replay_of_the_example_finds_both_frequencies(quiesce, tmp_path: Path) -> None:
    figures = replay(quiesce, EXAMPLE, "--column", "accel_m_s2", "--unit", "m_s2")
    rows = read_csv(tmp_path / "out/replay.csv")
    assert figures["rows"] == 6000 and figures["faults_seen"] == []
    assert rows["t_s"][0] == 2.0 and rows["t_s"][1] == 2.01
    for start_s, end_s, freq_Hz in ((3.1, 4.0, 10.0), (5.5, 8.0, 20.0)):
        chosen = (rows["t_s"] >= start_s) & (rows["t_s"] < end_s)
        assert rows["freq_is_valid"][chosen].all()
        assert np.abs(rows["freq_uHz"][chosen] * 1e-6 - freq_Hz).max() < 0.1
        assert (rows["current_cmd_mA"][chosen] > 4800).all()
    with Image.open(tmp_path / "out/replay.png") as picture:
        assert min(picture.size) > 500


@pytest.mark.parametrize("form", ["mat", "uff"])
def test_telemetry_goes_to_other_programs(quiesce, tmp_path: Path, form: str) -> None:
    words = ("--column", "accel_m_s2", "--unit", "m_s2", "--every", "20")
    replay(quiesce, EXAMPLE, *words)
    rows = read_csv(tmp_path / "out/replay.csv")
    figures = replay(quiesce, EXAMPLE, *words, "--format", form)
    assert figures["outputs"] == [f"out/replay.{form}", "out/replay.png"]
    if form == "mat":
        found = loadmat(tmp_path / "out/replay.mat", simplify_cells=True)
        assert {name: found[name].tolist() for name in rows} == {
            name: values.tolist() for name, values in rows.items() if name != "t_s"
        } | {"t_s": found["t_s"].tolist()}
        assert found["t_s"] == pytest.approx(rows["t_s"], abs=1e-6)
    else:
        sets = pyuff.UFF(str(tmp_path / "out/replay.uff")).read_sets()
        found = {one["id1"].strip(): one["data"] for one in sets}
        assert found["current_cmd"] == pytest.approx(rows["current_cmd_mA"], rel=1e-5)
        assert sets[0]["abscissa_inc"] == pytest.approx(0.02)


def test_unknown_format_is_refused(quiesce, tmp_path: Path) -> None:
    words = ("--column", "accel_m_s2", "--unit", "m_s2", "--format", "xls", "--out", "out")
    result = quiesce("replay", EXAMPLE, *words)
    assert result.returncode == 2 and "choose from" in result.stderr
    assert not (tmp_path / "out").exists()


@pytest.mark.slow
def test_replay_on_the_image_gives_the_same_rows(quiesce, image, tmp_path: Path) -> None:
    tables = []
    for target in ("host", "mps2"):
        replay(quiesce, EXAMPLE, "--column", "accel_m_s2", "--unit", "m_s2", "--target", target)
        tables.append((tmp_path / "out/replay.csv").read_bytes())
    assert tables[0] == tables[1]


@pytest.mark.slow
@pytest.mark.parametrize(("unit", "m_s2"), [("g", 9.80665), ("m_s2", 1.0), ("mm_s2", 1e-3)])
def test_replay_takes_units_other_names_and_rates(quiesce, tmp_path: Path, unit, m_s2) -> None:
    time_s = np.arange(2500) / 625.0
    accel = 0.5 * np.sin(2 * np.pi * 12.0 * time_s) / m_s2
    lines = [f"{t:.4f};{a:.6f}".replace(";", ",") for t, a in zip(time_s, accel, strict=True)]
    (tmp_path / "my.csv").write_text("\n".join([" time , acc", *lines, ""]))
    options = ["--column", "acc", "--time-column", "time", "--unit", unit, "--every", "1"]
    figures = replay(quiesce, tmp_path / "my.csv", *options, "--set", "tick_rate_Hz=2000")
    rows = read_csv(tmp_path / "out/replay.csv")
    assert figures["median_freq_Hz"] == pytest.approx(12.0, abs=0.05)
    assert figures["rate_Hz"] == pytest.approx(625.0, rel=1e-4)
    assert np.diff(rows["t_s"]) == pytest.approx(1 / 2000.0, abs=1e-6)
    assert rows["rms_um_s2"][-1] * 1e-6 == pytest.approx(0.5 / np.sqrt(2.0), rel=0.01)


@pytest.mark.slow
def test_replay_replaces_an_earlier_result(quiesce, tmp_path: Path) -> None:
    (tmp_path / "out").mkdir()
    (tmp_path / "out/replay.csv").write_text("old")
    (tmp_path / "out/mine.txt").write_text("kept")
    replay(quiesce, EXAMPLE, "--column", "accel_m_s2", "--unit", "m_s2")
    assert sorted(p.name for p in (tmp_path / "out").iterdir()) == [
        "mine.txt", "replay.csv", "replay.png",
    ]  # fmt: skip
    assert (tmp_path / "out/replay.csv").read_text().startswith("t_s,accel_um_s2")
    assert [p.name for p in tmp_path.iterdir()] == ["out"]


def test_record_makes_the_shipped_recording(quiesce, tmp_path: Path) -> None:
    result = quiesce("record", "step_10_20Hz", "--from-s", "2", "--to-s", "8", "--out", "made.csv")
    assert result.returncode == 0, result.stderr
    made, shipped = read_csv(tmp_path / "made.csv"), read_csv(EXAMPLE)
    assert np.array_equal(made["t_s"], shipped["t_s"])
    # Within some counts of the ADC: the last bits of a floating-point plant are the machine's.
    assert np.abs(made["accel_m_s2"] - shipped["accel_m_s2"]).max() < 5e-4


# Measured recordings


@pytest.mark.slow
def test_replay_follows_the_measured_sweep(quiesce, tmp_path: Path) -> None:
    options = ["--column", "mems_pkg_g", "--unit", "g", "--reference-column", "ref_piezo_g"]
    file = measured("shaker_sweep_0_11hz_100sps.csv")
    # The shaker stops at 181.5 s, 97.8 % of the way; the frequency must not outlive it.
    figures = replay(quiesce, file, *options, "--from-s", "23")
    reference = figures["reference"]
    assert reference["updates"] > 40000
    assert reference["within_pct"] >= 99.0
    assert 97.5 <= reference["valid_pct"] <= 98.1
    rows = read_csv(tmp_path / "out/replay.csv")
    assert not rows["freq_is_valid"][rows["t_s"] > 182.0].any()
    assert not rows["freq_is_valid"][rows["t_s"] < 15.0].any()
    driven = replay(quiesce, file, *options, "--from-s", "23", "--to-s", "181")["reference"]
    assert driven["valid_pct"] == 100.0 and driven["within_pct"] == 100.0


@pytest.mark.slow
def test_replay_finds_the_slow_sweep(quiesce) -> None:
    figures = replay(
        quiesce, measured("shaker_sweep_15_16hz_400sps.csv"),
        "--column", "mems_pkg_g", "--unit", "g", "--reference-column", "ref_piezo_g",
    )  # fmt: skip
    assert figures["median_freq_Hz"] == pytest.approx(15.5, abs=0.1)
    assert figures["reference"]["within_pct"] == 100.0


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "freq_Hz"),
    [("5.5hz", 10.31), ("10.2hz", 9.96), ("15.0hz", 14.21)],
)
def test_replay_finds_the_footbridge_peak(quiesce, name, freq_Hz) -> None:
    figures = replay(
        quiesce, measured(f"footbridge_b_shaker_{name}_639sps.csv"),
        "--column", "acc0_g", "--unit", "g",
    )  # fmt: skip
    assert figures["median_freq_Hz"] == pytest.approx(freq_Hz, abs=0.15)
