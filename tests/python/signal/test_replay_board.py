"""`quiesce replay --board`: columns of a recording for the sensors of a board."""

import csv
import json
import re
from pathlib import Path

import numpy as np
import pytest
from conftest import ROOT, Result, run_quiesce
from PIL import Image
from quiesce.engine.bench import Bench
from quiesce.engine.board import Sensor, load_board
from quiesce.engine.trace import read_trace
from quiesce.signal import picture
from quiesce.signal.channels import NO_SAMPLE, Channel, sampled
from quiesce.signal.recording import Recording

BOARD = ROOT / "sim_hil/data/boards/two_storeys.toml"
FREQ_Hz = 4.0
RATE_Hz = 500.0
FLOOR_mm, ROOF_mm, ROOF_PHASE = 1.0, 2.5, 0.6
FROM_s = 15.0  # the filters have settled
ALL = ["floor_accel=a_floor:g", "roof_accel=a_roof:m_s2", "upper_stroke=lvdt:mm"]


def written(file: Path, columns: dict[str, np.ndarray]) -> Path:
    rows = zip(*columns.values(), strict=True)
    lines = [",".join(columns), *(",".join(f"{value:.9g}" for value in row) for row in rows)]
    file.write_text("\n".join(lines) + "\n")
    return file


@pytest.fixture(scope="module")
def recording(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Floor and roof at one frequency; what two accelerometers and a stroke sensor see of it."""
    time_s = np.arange(int(20 * RATE_Hz)) / RATE_Hz
    omega = 2 * np.pi * FREQ_Hz
    floor_mm = FLOOR_mm * np.sin(omega * time_s)
    roof_mm = ROOF_mm * np.sin(omega * time_s + ROOF_PHASE)
    return written(
        tmp_path_factory.mktemp("recorded") / "rig.csv",
        {
            "t_s": time_s,
            "a_floor": -(omega**2) * 1e-3 * floor_mm / 9.80665,
            "a_roof": -(omega**2) * 1e-3 * roof_mm,
            "lvdt": roof_mm - floor_mm,
        },
    )


def words(sensors: list[str]) -> list[str]:
    return [word for sensor in sensors for word in ("--sensor", sensor)]


def replay(quiesce, file: Path, sensors: list[str], *options: str) -> dict:
    board = [] if "--board" in options else ["--board", str(BOARD)]
    result = quiesce(
        "replay", file, *board, *words(sensors), "--out", "out", "--json", "--every", "1", *options
    )
    assert result.returncode == 0, result.stderr
    return json.loads(result.stdout)


def read_csv(file: Path) -> dict[str, np.ndarray]:
    with file.open() as stream:
        rows = list(csv.reader(stream))
    return dict(zip(rows[0], np.array(rows[1:], dtype=float).T, strict=True))


def amplitude(rows: dict[str, np.ndarray], name: str) -> complex:
    """Of the sine at the frequency of the motion."""
    late = rows["t_s"] >= FROM_s
    turn = np.exp(-2j * np.pi * FREQ_Hz * rows["t_s"][late])
    return 2j * np.mean(rows[name][late] * turn)


@pytest.fixture(scope="module")
def whole(build: Path, recording: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder of a replay of all of it, with its figures."""
    folder = tmp_path_factory.mktemp("whole")

    def quiesce(*arguments: str | Path) -> Result:
        return run_quiesce(folder, *arguments)

    figures = replay(quiesce, recording, ALL, "--set", "law=fuzzy_selftune")
    (folder / "figures.json").write_text(json.dumps(figures))
    return folder


@pytest.fixture(scope="module")
def figures(whole: Path) -> dict:
    return json.loads((whole / "figures.json").read_text())


@pytest.fixture(scope="module")
def rows(whole: Path) -> dict[str, np.ndarray]:
    return read_csv(whole / "out/replay.csv")


# Known motion


def high_pass(*corners_Hz: float) -> complex:
    """Of first order each, at the frequency of the motion."""
    return complex(np.prod([1j * FREQ_Hz / (1j * FREQ_Hz + corner) for corner in corners_Hz]))


DC_Hz, VELOCITY_Hz = 0.2, 0.5  # defaults of dc_cutoff_mHz and velocity_cutoff_mHz


def test_known_motion_gives_the_right_picture(whole: Path, figures: dict, rows) -> None:
    assert figures["sensors"] == ALL and figures["faults_seen"] == []
    floor, roof = FLOOR_mm, ROOF_mm * np.exp(1j * ROOF_PHASE)
    per_s = 2 * np.pi * FREQ_Hz
    accel, velocity = high_pass(DC_Hz), high_pass(DC_Hz, VELOCITY_Hz)
    moved = high_pass(DC_Hz, VELOCITY_Hz, VELOCITY_Hz)
    for name, expected, tolerance_deg in (
        ("floor_accel_um_s2", -1e3 * per_s**2 * floor * accel, 0.5),
        ("roof_accel_um_s2", -1e3 * per_s**2 * roof * accel, 0.5),
        ("floor_velocity_um_s", 1e3j * per_s * floor * velocity, 2.0),
        ("floor_displacement_nm", 1e6 * floor * moved, 2.0),
        ("roof_displacement_nm", 1e6 * roof * moved, 2.0),
        ("lower_stroke_nm", 1e6 * floor * moved, 2.0),
        ("upper_stroke_nm", 1e6 * (roof - floor), 0.5),
    ):
        found = amplitude(rows, name)
        assert abs(found) == pytest.approx(abs(expected), rel=0.02), name
        assert abs(np.angle(found / expected, deg=True)) < tolerance_deg, name
    with Image.open(whole / "out/replay.png") as drawn:
        assert min(drawn.size) > 500


def test_summary_is_that_of_the_rows(figures: dict, rows: dict[str, np.ndarray]) -> None:
    assert set(figures["bodies"]) == {"floor", "roof"}
    accel = figures["bodies"]["roof"]["accel_rms_m_s2"]
    per_s = 2 * np.pi * FREQ_Hz
    assert accel == pytest.approx(1e-3 * per_s**2 * ROOF_mm / np.sqrt(2.0), rel=0.02)
    for name in ("lower", "upper"):
        command_A = 1e-3 * rows[f"{name}_current_cmd_mA"]
        assert command_A.max() > 0.5
        found = figures["dampers"][name]
        assert found["mean_current_A"] == pytest.approx(command_A.mean(), abs=1e-4)
        assert found["max_current_A"] == pytest.approx(command_A.max(), abs=1e-4)


def test_sensor_that_is_not_named_leaves_its_signals_unknown(
    quiesce, recording: Path, tmp_path: Path
) -> None:
    figures = replay(quiesce, recording, ALL[1:2])
    assert figures["bodies"]["floor"]["disp_rms_mm"] is None
    assert figures["bodies"]["roof"]["disp_rms_mm"] is not None
    assert figures["dampers"]["lower"]["stroke_rms_mm"] is None
    rows = read_csv(tmp_path / "out/replay.csv")
    assert not picture.is_valid(rows, picture.ACCEL, 0).any()
    assert picture.is_valid(rows, picture.ACCEL, 1).all()


def test_replay_of_a_recorded_run_gives_its_commands(quiesce, tmp_path: Path) -> None:
    rig = ROOT / "sim_hil/data/rigs/two_storeys.toml"
    assert quiesce("record", rig, "--law", "phase", "--out", "rig.csv").returncode == 0
    sensors = [
        "floor_accel=floor_accel_m_s2:m_s2",
        "roof_accel=roof_accel_m_s2:m_s2",
        "upper_stroke=upper_stroke_mm:mm",
    ]
    replay(quiesce, tmp_path / "rig.csv", sensors, "--set", "law=phase")
    rows = read_csv(tmp_path / "out/replay.csv")
    options = ["--scenario", str(rig), "--law", "phase", "--trace", str(tmp_path / "trace")]
    Bench().call("run", *options)
    run = read_trace(tmp_path / "trace")
    for name in ("upper_current_cmd_mA", "roof_displacement_nm", "upper_stroke_nm"):
        assert np.array_equal(rows[name], run[name]), name
    assert len(np.unique(rows["upper_current_cmd_mA"])) > 100


@pytest.mark.slow
def test_image_gives_the_same_rows(quiesce, image: Path, recording: Path, tmp_path: Path) -> None:
    tables = []
    for target in ("host", "mps2"):
        replay(quiesce, recording, ALL, "--target", target)
        tables.append((tmp_path / "out/replay.csv").read_bytes())
    assert tables[0] == tables[1]


# Sensors


SLOW = Sensor("s", "stroke", "nm", 1000.0, -1, 5, 32767, 5000)


def test_sensor_with_a_period_has_a_sample_in_the_first_tick_of_each() -> None:
    line = Recording(0.0, 1000.0, {"x": np.arange(12.0)}, 0.0)
    counts = sampled(line, Channel("x", 1e6), SLOW, 1000)
    expected = np.full(12, NO_SAMPLE)
    expected[[0, 5, 10]] = [5, 5 - 5000, 5 - 10000]
    assert counts.tolist() == expected.tolist()


def test_a_period_that_is_no_whole_number_of_ticks() -> None:
    sensor = Sensor("s", "stroke", "nm", 1000.0, 1, 0, 32767, 2500)
    assert np.flatnonzero(sensor.is_due(11, 1000)).tolist() == [0, 3, 5, 8, 10]


def test_counts_end_at_the_full_scale_and_stand_for_their_values() -> None:
    counts = SLOW.counts(np.array([0.0, 1e6, -1e9, 1e9]))
    assert counts.tolist() == [5, -995, 32767, -32767]
    assert SLOW.values(counts)[:2].tolist() == [0.0, 1e6]


def test_bits_of_validity_are_those_of_the_header() -> None:
    header = (ROOT / "firmware/include/quiesce_valid.h").read_text()
    bits = {name: int(bit) for name, bit in re.findall(r"QUIESCE_VALID_(\w+) = (\d+)", header)}
    for name in "ACCEL VELOCITY DISPLACEMENT STROKE STROKE_VELOCITY FORCE CURRENT".split():
        assert getattr(picture, name).first_bit == bits[name]
    assert picture.VOLTAGE.first_bit == bits["VOLTAGE"]
    assert picture.TEMPERATURE.first_bit == bits["TEMPERATURE"]


def test_columns_are_those_of_the_picture(rows: dict[str, np.ndarray]) -> None:
    expected = picture.columns(load_board(Bench(), BOARD))
    assert [*rows][-len(expected) :] == expected and len(expected) == 2 + 2 * 3 + 2 * 8


# What is refused


@pytest.mark.parametrize(
    ("options", "expected"),
    [
        (["roof_accel"], ["--sensor roof_accel: expected NAME=COLUMN:UNIT"]),
        (["roof_accel=a_roof"], ["expected NAME=COLUMN:UNIT"]),
        (["=a_roof:g"], ["expected NAME=COLUMN:UNIT"]),
        (["attic=a_roof:g"], ["no sensor 'attic'", "floor_accel, roof_accel, upper_stroke"]),
        (["roof_accel=none:g"], ["rig.csv", "no column 'none'", "a_floor, a_roof, lvdt"]),
        (["roof_accel=a_roof:mm"], ["measures acceleration", "g, m_s2, mm_s2"]),
        (["roof_accel=a_roof:furlong"], ["measures acceleration", "g, m_s2, mm_s2"]),
        ([ALL[1], "upper_stroke=lvdt:g"], ["measures stroke", "m, mm, um"]),
        (ALL[:1], ["no column for roof_accel", "--sensor roof_accel=COLUMN:UNIT"]),
        ([], ["no column for roof_accel"]),
        ([ALL[1], "roof_accel=a_floor:g"], ["a second column for roof_accel"]),
    ],
)
def test_sensor_option_is_refused(refused, recording: Path, options, expected) -> None:
    message = refused("replay", recording, "--board", BOARD, *words(options), "--out", "out")
    for text in expected:
        assert text in message


@pytest.mark.parametrize(
    ("options", "expected"),
    [
        ([], ["--column and --unit are needed, or --board and --sensor"]),
        (["--column", "a_roof"], ["--column and --unit are needed"]),
        (["--sensor", ALL[1]], ["--sensor goes with --board"]),
        (["--board", BOARD, "--column", "a_roof"], ["--column goes without --board"]),
        (["--board", BOARD, "--unit", "g"], ["--unit goes without --board"]),
        (["--board", BOARD, "--reference-column", "x"], ["--reference-column goes without"]),
        (["--board", "none.toml", "--sensor", ALL[1]], ["none.toml"]),
        (
            ["--board", BOARD, "--sensor", ALL[1], "--set", "accel_polarity=-1"],
            ["accel_polarity", "comes from the board file"],
        ),
    ],
)
def test_options_that_do_not_go_together_are_refused(
    refused, recording: Path, options, expected
) -> None:
    message = refused("replay", recording, *options, "--out", "out")
    for text in expected:
        assert text in message
