"""What `quiesce report` reads, and what it refuses in one line."""

import json
import sys
from pathlib import Path

import can
import numpy as np
import pytest
from before_after.recordings import (
    DATABASE,
    RATE_Hz,
    configuration_frames,
    figures,
    frame,
    noise,
    protected,
    record,
    sample_frames,
    write_csv,
    write_mdf,
)
from conftest import Result
from quiesce.before_after.files.open_file import How, open_file
from quiesce.before_after.motion import scale_in_name, wanted
from quiesce.can.mdf import write_mdf as write_bus_mdf
from quiesce.cli.main import main

REPORT = ("--json", "--out", "page.html")


@pytest.fixture
def report(tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch):
    """The command in an empty folder, in this process: its libraries are slow to import."""
    monkeypatch.chdir(tmp_path)

    def run(*words: str) -> Result:
        code = main(["report", *words])
        return Result(words, code, *capsys.readouterr())

    return run


@pytest.fixture
def refused(report, tmp_path: Path):
    """It must refuse: exit code 2, one line beside those of progress, nothing written."""

    def check(*words: str) -> str:
        before = sorted(tmp_path.rglob("*"))
        result: Result = report(*words)
        assert result.returncode == 2, result.stdout + result.stderr
        assert result.stdout == "" and sorted(tmp_path.rglob("*")) == before
        lines = [one for one in result.stderr.splitlines() if not one.startswith("reading ")]
        assert len(lines) == 1 and lines[0].startswith("quiesce: "), result.stderr
        return lines[0]

    return check


def ratio(result: Result, quantity: str = "acceleration_rms", channel: str = "") -> float:
    assert result.returncode == 0, result.stderr
    return figures(result.stdout, channel)[quantity]["ratio"]


# CSV


@pytest.mark.parametrize(
    ("head", "name", "motion", "per_one"),
    [
        ("acc_g", "acc", "acceleration", 9.80665),
        ("Roof (m/s^2)", "Roof", "acceleration", 1.0),
        ("floor [mm/s]", "floor", "velocity", 1e-3),
        ("gap_um", "gap", "displacement", 1e-6),
        ("a5_mm_s2", "a5", "acceleration", 1e-3),
        ("v/in/s", "v", "velocity", 0.0254),
        ("Acc 1, tip (g)", "Acc 1, tip", "acceleration", 9.80665),
    ],
)
def test_a_header_tells_name_and_unit(head: str, name: str, motion: str, per_one: float) -> None:
    found, scale = scale_in_name(head)
    assert scale is not None
    assert (found, scale.motion.name) == (name, motion)
    assert scale.per_one == pytest.approx(per_one)


@pytest.mark.parametrize("head", ["acc", "force_N", "temp_C", "g"])
def test_a_header_without_motion_has_no_unit(head: str) -> None:
    assert scale_in_name(head) == (head, None)


def test_units_are_converted_and_names_matched_without_them(report, tmp_path: Path) -> None:
    write_csv(tmp_path / "b.csv", {"acc_g": noise(1)})
    write_csv(tmp_path / "a.csv", {"acc_mm_s2": noise(2, 0.5) * 9806.65})
    assert ratio(report("b.csv", "a.csv", *REPORT)) == pytest.approx(0.5, rel=0.03)


def test_decimal_commas_and_names_in_two_languages(report, tmp_path: Path) -> None:
    write_csv(tmp_path / "b.csv", {"Dach (m/s²)": noise(1)}, "Zeit (s)")
    text = (tmp_path / "b.csv").read_text().replace(",", ";").replace(".", ",")
    (tmp_path / "b.csv").write_text(text)
    write_csv(tmp_path / "a.csv", {"roof_m_s2": noise(2, 0.5)})
    (tmp_path / "a.csv").write_text((tmp_path / "a.csv").read_text().replace("t_s", "Zeit_s"))
    words = ("--time", "Zeit:s", "--channel", "Dach=roof")
    assert "no column is named 'Zeit'" in report("b.csv", "a.csv", *words).stderr
    (tmp_path / "b.csv").write_text(text.replace("Zeit (s)", "t (s)"))
    write_csv(tmp_path / "a.csv", {"roof_m_s2": noise(2, 0.5)})
    found = report("b.csv", "a.csv", "--channel", "Dach=roof", *REPORT)
    assert ratio(found) == pytest.approx(0.5, rel=0.03)


def test_stated_units_factors_and_rates(report, tmp_path: Path) -> None:
    write_csv(tmp_path / "b.csv", {"ch1": noise(1) / 0.012, "x": noise(3)}, "n")
    write_csv(tmp_path / "a.csv", {"ch1": noise(2, 0.5) / 0.012, "x": noise(3)}, "n")
    line = report("b.csv", "a.csv", "--rate-hz", "200").stderr
    assert "no channel with a known unit" in line and "--channel NAME:UNIT" in line
    line = report("b.csv", "a.csv", "--rate-hz", "200", "--channel", "ch1").stderr
    assert "the unit of channel 'ch1' is unknown" in line
    words = ("--rate-hz", "200", "--channel", "ch1:0.012*m/s2")
    found = figures(report("b.csv", "a.csv", *words, *REPORT).stdout)["acceleration_rms"]
    assert found["ratio"] == pytest.approx(0.5, rel=0.03)
    # Of white noise of 1 m/s2 what is in the band: 0.5 to 80 of 100 Hz.
    assert found["before"] == pytest.approx(np.sqrt(79.5 / 100.0), rel=0.03)


def test_other_lengths_rates_gaps_and_clipping_are_told(report, tmp_path: Path) -> None:
    write_csv(tmp_path / "b.csv", {"acc_m_s2": noise(1, duration_s=60.0)})
    after = np.clip(noise(2, 0.5, 40.0), -0.6, 0.6)
    rows = write_csv(tmp_path / "a.csv", {"acc_m_s2": after}, rate_Hz=160.0).read_text().split("\n")
    (tmp_path / "a.csv").write_text("\n".join(rows[:2000] + rows[2100:]))
    result = report("b.csv", "a.csv", "--out", "page.html")
    assert result.returncode == 0, result.stderr
    page = (tmp_path / "page.html").read_text()
    for words in (
        "after: 1 gap of up to 100 samples",
        "after: clipped:",
        "before: resampled from 200 to 160 Hz",
        "the recordings are 60 s and 26.87 s long",
        "no reference channel",
    ):
        words = words.replace("26.87", f"{(len(rows) - 2101) / 160.0 - 0.00625:.4g}")
        assert words in result.stdout and words in page


# MDF


def test_channels_of_a_logger(report, tmp_path: Path) -> None:
    """Two groups with clocks of their own, units and integers with an own conversion."""
    for name, seed, size in (("b.mf4", 1, 1.0), ("a.mf4", 2, 0.5)):
        base, roof = noise(seed + 10), noise(seed, size)
        channels = {"Base": ("m/s^2", base), "Roof": ("g", roof), "T": ("degC", roof)}
        write_mdf(tmp_path / name, channels, RATE_Hz)
    found = report("b.mf4", "a.mf4", "--reference", "Base", *REPORT)
    assert ratio(found, channel="Roof") == pytest.approx(0.5, rel=0.03)
    data = json.loads(found.stdout)
    assert data["files"]["before"]["kind"] == "MDF" and data["reference"] == "Base"
    assert [one["name"] for one in data["channels"]] == ["Roof"]


def test_invalid_samples_of_a_logger_are_missing_ones(tmp_path: Path) -> None:
    from asammdf import MDF, Signal

    values = noise(1)
    bad = np.zeros(len(values), bool)
    bad[[50, 700]] = True
    time_s = np.arange(len(values)) / RATE_Hz
    with MDF(version="4.10") as mdf:
        one = Signal(values, time_s, name="Roof", unit="g", invalidation_bits=bad)
        mdf.append(one)
        mdf.save(tmp_path / "a.mf4")
    found, _ = open_file(tmp_path / "a.mf4", How()).samples("Roof")
    assert len(found) == len(values) - 2


def test_a_logger_may_record_a_bus_beside_its_channels(tmp_path: Path) -> None:
    from asammdf import MDF

    log = record(tmp_path / "bus.mf4", sample_frames(np.arange(300)))
    logger = write_mdf(tmp_path / "logger.mf4", {"CAN:1.acc": ("g", noise(1))}, RATE_Hz)
    MDF.stack([logger, log], version="4.10").save(tmp_path / "both.mf4")
    found = open_file(tmp_path / "both.mf4", How())
    assert found.known("CAN:1.acc") and not [name for name in found.scales if "Frame" in name]
    assert len(found.samples("CAN:1.acc")[1]) == len(noise(1))
    assert wanted("--channel", "CAN:1.acc:").before == "CAN:1.acc"


FOREIGN_DBC = """VERSION ""
BU_: Box
BO_ 291 Tip: 4 Box
 SG_ tip_acc : 0|32@1- (0.001,0) [0|0] "m/s^2" Box
"""


def test_another_bus_is_read_by_the_database_in_its_log(tmp_path: Path) -> None:
    values = np.round(1000.0 * noise(1)).astype("<i4")
    frames = [
        can.Message(
            arbitration_id=291, data=one.tobytes(), timestamp=i / RATE_Hz, is_extended_id=False
        )
        for i, one in enumerate(values)
    ]
    dbc = ("box.dbc", FOREIGN_DBC.encode(), "application/octet-stream")
    write_bus_mdf(tmp_path / "a.mf4", frames, [dbc], "")
    found = open_file(tmp_path / "a.mf4", How())
    scale = found.scales["tip_acc"]
    assert scale is not None and scale.motion.name == "acceleration" and scale.per_one == 1.0
    assert found.samples("tip_acc")[1] == pytest.approx(1e-3 * values)


# Logs of the bus


@pytest.mark.parametrize("suffix", [".mf4", ".log", ".asc", ".blf", ".csv"])
def test_a_log_has_samples_scale_and_configuration(tmp_path: Path, suffix: str) -> None:
    counts = np.round(1e5 * noise(1, duration_s=15.0)).astype(int)
    frames = configuration_frames({"law": 2, "accel_scale_nm_s2": 1500})
    file = record(tmp_path / f"a{suffix}", frames + sample_frames(counts))
    found = open_file(file, How())
    time_s, values = found.samples("accel")
    assert values.tolist() == counts.tolist()
    assert time_s == pytest.approx(np.arange(len(counts)) / 1000.0)
    scale = found.scales["accel"]
    assert scale is not None and scale.per_one == pytest.approx(1.5e-6)
    assert found.origin.parameters["law"] == 2
    assert found.origin.facts["firmware"] == "version 0.2.0"
    assert len(found.origin.facts["parameters' hash"]) == 8


def test_a_table_that_somebody_asked_for_is_told(tmp_path: Path) -> None:
    """CRC of the law's table, as `quiesce can tables` asks; what else is asked for is no CRC, and
    a road that nobody knows is none."""
    operation = DATABASE.number("ServiceRequest", "operation", "TABLE_INFO")
    frames = []
    asked = [(0, 1, 77), (0, 0, 0x89ABCDEF - 2**32), (0, 2, 5), (200, 0, 6)]
    for alive, (road, what, answer) in enumerate(asked):
        on_road = {"operation": operation, "param_index": road}
        ask = protected("ServiceRequest", alive, **on_road, param_value=what)
        reply = protected("ServiceReply", alive, **on_road, param_value=answer)
        frames += [frame("ServiceRequest", 0.1 * alive, ask)]
        frames += [frame("ServiceReply", 0.1 * alive + 0.01, reply)]
    file = record(tmp_path / "a.log", frames + sample_frames(np.arange(300)))
    facts = open_file(file, How()).origin.facts
    assert {name: text for name, text in facts.items() if "road" in name} == {
        "table on road law": "89ABCDEF"
    }


def test_lost_and_stale_samples_are_missing_ones(tmp_path: Path) -> None:
    counts = np.arange(2000)
    frames = sample_frames(counts)
    frames[300].data = DATABASE.encode("RawSample", tick_low=(2**16 - 1000 + 300) % 2**16)
    del frames[700:702]
    time_s, values = open_file(record(tmp_path / "a.log", frames), How()).samples("accel")
    assert values.tolist() == [n for n in range(2000) if n not in (300, 700, 701)]
    assert np.diff(time_s).max() == pytest.approx(3 * np.diff(time_s).min(), rel=1e-6)


def test_samples_of_a_node_need_their_scale(report, tmp_path: Path) -> None:
    for name, seed, size in (("b.log", 1, 1.0), ("a.log", 2, 0.5)):
        counts = np.round(1e5 * noise(seed, size)).astype(int)
        data = [protected("SensorSample1", i, sample_counts=int(n)) for i, n in enumerate(counts)]
        data[5] = data[5][:-1] + bytes([data[5][-1] ^ 1])  # a wrong CRC: no sample
        frames = [frame("SensorSample1", i / RATE_Hz, one) for i, one in enumerate(data)]
        record(tmp_path / name, frames)
    line = report("b.log", "a.log", "--channel", "SensorSample1").stderr.splitlines()[-1]
    assert "the unit of channel 'SensorSample1' is unknown" in line
    found = report("b.log", "a.log", "--channel", "SensorSample1:1e-5*m/s2", *REPORT)
    assert ratio(found) == pytest.approx(0.5, rel=0.03)
    doubts = json.loads(found.stdout)["channels"][0]["doubts"]
    assert any("1 of 8000 samples are missing" in line for line in doubts)


# Refused


GOOD = {"acc_m_s2": noise(1)}


def lines_of(file: Path) -> list[str]:
    return file.read_text().splitlines()


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda rows: [], "the file is empty"),
        (lambda rows: rows[:1], "0 samples; at least 256"),
        (lambda rows: rows[:2], "1 samples; at least 256"),
        (lambda rows: rows[:200], "199 samples; at least 256"),
        (lambda rows: rows[1:], "no header line"),
        (lambda rows: [*rows[:9], "0.04,nan", *rows[10:]], ":10: column 'acc_m_s2': 'nan'"),
        (lambda rows: [*rows[:9], "0.04,high", *rows[10:]], "'high' is not a number"),
        (lambda rows: [*rows[:9], "0.04,", *rows[10:]], "an empty cell"),
        (lambda rows: [*rows[:9], "0.01,1", *rows[10:]], "time does not advance at sample 9"),
        (lambda rows: [*rows[:9], rows[8], *rows[10:]], "time does not advance"),
        (lambda rows: ["t_s,acc_m_s2", *(f"{n / 200},1" for n in range(500))], "all samples are"),
        (lambda rows: [rows[0].replace("acc_m_s2", "acc_V"), *rows[1:]], "(unit unknown)"),
        (lambda rows: [rows[0].replace("acc_m_s2", "acc_mm"), *rows[1:]], "measure the same"),
        (lambda rows: [rows[0].replace("acc_m_s2", "other_g"), *rows[1:]], "has other (g)"),
        (lambda rows: [rows[0].replace("t_s", "sample"), *rows[1:]], "no column is clearly the"),
        (lambda rows: ["just some text", "and more of it"], "one column only"),
        (lambda rows: ["\x89PNG\r", "\x00\x01"], "this is a PNG image"),
        (lambda rows: ['{"columns":["t_s","a_g"],"rows":9}', "xx"], "cut off"),
        (lambda rows: ['{"columns":["a_g"],"rows":0}'], "trace"),
    ],
)
def test_a_malformed_file_is_refused(refused, tmp_path: Path, change, words: str) -> None:
    write_csv(tmp_path / "b.csv", GOOD)
    rows = lines_of(write_csv(tmp_path / "a.csv", {"acc_m_s2": noise(2)}))
    (tmp_path / "a.csv").write_bytes("\n".join([*change(rows), ""]).encode("latin-1"))
    line = refused("b.csv", "a.csv", "--out", "out")
    assert words in line and "a.csv" in line


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("b.csv", "none.csv"), "none.csv: No such file"),
        (("b.csv", "."), "Is a directory"),
        (("b.csv", "b.csv"), "one recording, byte for byte"),
        (("b.csv", "a.csv", "--channel", "acx"), "did you mean 'acc'"),
        (("b.csv", "a.csv", "--channel", "acc:furlong"), "'furlong' is no unit of motion"),
        (("b.csv", "a.csv", "--channel", "acc:x*g"), "'x' is not a factor"),
        (("b.csv", "a.csv", "--channel", "acc:0*g"), "'0' is not a factor"),
        (("b.csv", "a.csv", "--channel", "acc="), "a name is missing"),
        (("b.csv", "a.csv", "--channel", "acc", "--channel", "acc_m_s2"), "acc is named twice"),
        (("b.csv", "a.csv", "--reference", "acc_m_s2"), "the only channel"),
        (("b.csv", "a.csv", "--reference", "base"), "no channel 'base'"),
        (("b.csv", "a.csv", "--band", "5", "2"), "the band 5 .. 2 Hz is empty"),
        (("b.csv", "a.csv", "--band", "1", "150"), "above half of the lowest sampling rate"),
        (
            ("b.csv", "a.csv", "--reference", "x_V:g", "--band", "10.01", "10.02"),
            "no line of the spectrum of acc is in it",
        ),
        (("b.csv", "a.csv", "--band", "0.05", "50"), "too short for a band from 0.05 Hz"),
        (("b.csv", "a.csv", "--band", "x", "50"), "--band"),
        (("b.csv", "a.csv", "--machine", "medium"), "medium:rigid"),
        (("b.csv", "a.csv", "--limits", "none.toml"), "none.toml: No such file"),
        (("b.csv", "a.csv", "--out", "b.csv"), "b.csv"),
        (("b.csv", "a.csv", "--time", "acc:m/s2"), "no unit of time"),
    ],
)
def test_a_wrong_word_is_refused(refused, tmp_path: Path, words, said: str) -> None:
    write_csv(tmp_path / "b.csv", {**GOOD, "x_V": noise(3)})
    write_csv(tmp_path / "a.csv", {"acc_m_s2": noise(2), "x_V": noise(4)})
    assert said in refused(*words)


def test_a_cut_mdf_is_refused(refused, tmp_path: Path) -> None:
    write_csv(tmp_path / "b.csv", GOOD)
    whole = write_mdf(tmp_path / "a.mf4", {"acc": ("g", noise(1))}, RATE_Hz).read_bytes()
    for size in (30, 200, len(whole) // 2, len(whole) - 100):
        (tmp_path / "a.mf4").write_bytes(whole[:size])
        assert "a.mf4" in refused("b.csv", "a.mf4")
    (tmp_path / "a.mf4").write_text("text")
    assert "not an MDF file" in refused("b.csv", "a.mf4")


def test_a_cut_log_is_refused(refused, tmp_path: Path) -> None:
    write_csv(tmp_path / "b.csv", GOOD)
    frames = configuration_frames({}) + sample_frames(np.arange(3000))
    whole = record(tmp_path / "a.mf4", frames).read_bytes()
    (tmp_path / "a.mf4").write_bytes(whole[: len(whole) // 2])
    assert "a.mf4" in refused("b.csv", "a.mf4")
    (tmp_path / "a.log").write_text("(1.0) can0 100#00\n(1.1) can0 1")
    assert "a.log" in refused("b.csv", "a.log")


def test_a_log_without_samples_says_how_to_record_them(refused, tmp_path: Path) -> None:
    write_csv(tmp_path / "b.csv", GOOD)
    record(tmp_path / "a.log", configuration_frames({}))
    assert "quiesce can record --raw" in refused("b.csv", "a.log")


def test_without_asammdf_the_extra_is_named(refused, tmp_path: Path, monkeypatch) -> None:
    write_csv(tmp_path / "b.csv", GOOD)
    (tmp_path / "a.mf4").write_bytes(b"MDF     4.10    ")
    monkeypatch.setitem(sys.modules, "asammdf", None)
    assert "needs the extra 'mdf'" in refused("b.csv", "a.mf4")
