"""`quiesce report`: verdicts, page and JSON; from the bench by the recorder to the page."""

import hashlib
import json
import re
from pathlib import Path

import numpy as np
import pytest
from before_after.recordings import (
    configuration_frames,
    figures,
    noise,
    record,
    sample_frames,
    write_csv,
)
from can_bus import Controller, build_peer
from conftest import ROOT, Result
from quiesce.base.paths import measurements
from quiesce.before_after.figures import Found
from quiesce.before_after.files.open_file import How, open_file
from quiesce.before_after.limits import judged, read_limits
from quiesce.before_after.motion import wanted
from quiesce.before_after.run import Options, compared
from quiesce.can.parameters import parameters
from quiesce.cli.main import main
from quiesce.compare.zones import machines
from quiesce.engine.bench import Bench
from quiesce.engine.params import effective_params
from quiesce.engine.trace import read_trace
from quiesce.signal.recording import read_recording
from scipy import signal

MEASURED = measurements("vibration")
REPORT = ("--json", "--out", "page.html")


@pytest.fixture
def report(tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch):
    """The command in an empty folder, in this process: its libraries are slow to import."""
    monkeypatch.chdir(tmp_path)

    def run(*words: str) -> Result:
        code = main(["report", *words])
        return Result(words, code, *capsys.readouterr())

    return run


def halved(folder: Path) -> None:
    """b.csv and a.csv: acceleration of 1 and of 0.5 m/s2 over 0 .. 100 Hz, on the same floor."""
    for name, size, seed in (("b.csv", 1.0, 1), ("a.csv", 0.5, 2)):
        floor = noise(seed + 10)
        write_csv(folder / name, {"roof_m_s2": noise(seed, size), "floor_m_s2": floor})


def limits(folder: Path, *tables: str) -> None:
    (folder / "limits.toml").write_text("".join(f"[[limit]]\n{one}\n" for one in tables))


# Limits


@pytest.fixture(scope="module")
def channels(tmp_path_factory: pytest.TempPathFactory) -> list[Found]:
    """The roof, with the floor as the reference and zones of a machine."""
    folder = tmp_path_factory.mktemp("halved")
    halved(folder)
    sides = [open_file(folder / name, How()) for name in ("b.csv", "a.csv")]
    reference = wanted("--reference", "floor")
    return compared(
        *sides, Options(reference=reference, machine=machines()["large:rigid"])
    ).channels


@pytest.mark.parametrize(
    ("limit", "is_kept", "words"),
    [
        ('quantity = "acceleration_rms"\nmost = 0.6\nunit = "m/s2"', True, "pass"),
        ('quantity = "acceleration_rms"\nmost = 0.4\nunit = "m/s2"', False, "fail"),
        ('quantity = "acceleration_rms"\nmost = 0.05\nunit = "g"', True, "at most 0.4903 m/s2"),
        ('quantity = "acceleration_rms"\nleast_fall_pct = 45', True, "pass"),
        ('quantity = "acceleration_rms"\nleast_fall_pct = 60', False, "fail"),
        ('quantity = "acceleration_rms"\nleast_fall_pct = 50', None, "within its uncertainty"),
        ('quantity = "kurtosis"\nmost = 4', True, "pass"),
        ('quantity = "normalised_rms"\nleast_fall_pct = 30', None, "RMS under the same input"),
        ('quantity = "third_octave_rms"\nband_Hz = 20\nmost = 0.2\nunit = "m/s2"', True, "20 Hz"),
        ('quantity = "third_octave_rms"\nband_Hz = 20\nmost = 1\nunit = "mm/s2"', False, "20 Hz"),
        ('quantity = "zone"\nmost = "A"', False, "at most A"),
        ('quantity = "zone"\nmost = "B"', True, "at most B"),
    ],
)
def test_a_limit_is_kept_or_missed(
    channels: list[Found], tmp_path: Path, limit: str, is_kept: bool | None, words: str
) -> None:
    limits(tmp_path, f'channel = "roof"\n{limit}\nnote = "clause 7"')
    (found,) = judged(read_limits(tmp_path / "limits.toml"), channels)
    assert is_kept is None or found.is_kept == is_kept
    assert words in f"{found.what}: {found.limit}: {found.value}: {found.word}"
    assert (found.channel, found.note) == ("roof", "clause 7")


def test_exit_code_and_page_tell_of_a_missed_limit(report, tmp_path: Path) -> None:
    halved(tmp_path)
    for most, code, word in ((0.6, 0, "pass"), (0.4, 1, "fail")):
        one = f'channel = "roof"\nquantity = "acceleration_rms"\nmost = {most}\nunit = "m/s2"'
        limits(tmp_path, one)
        options = ("--channel", "roof", "--limits", "limits.toml", "--out", "page.html")
        result = report("b.csv", "a.csv", *options)
        assert result.returncode == code, result.stderr
        assert re.search(rf"roof +acceleration, RMS +at most {most} m/s2 .*{word}", result.stdout)
        assert f"{code} of 1 limits missed" in (tmp_path / "page.html").read_text()


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "no [[limit]] in it"),
        ("limits = 1", "unknown key 'limits'"),
        ("[[limit]", "not a TOML file"),
        ("limit = 3", "no [[limit]] in it"),
        ("limit = [3]", "limit 1: expected a table"),
        ('[[limit]]\nquantity = "crest"\nmost = 3', "channel is missing"),
        ('[[limit]]\nchannel = "roof"\nquantity = "crets"\nmost = 3', "did you mean 'crest'"),
        ('[[limit]]\nchannel = "roof"\nquantity = "crest"', "one of most and least_fall_pct"),
        (
            '[[limit]]\nchannel = "roof"\nquantity = "crest"\nmost = 3\nleast_fall_pct = 3',
            "one of most and least_fall_pct",
        ),
        ('[[limit]]\nchannel = "roof"\nquantity = "crest"\nmost = "3"', "most is a number"),
        ('[[limit]]\nchannel = "roof"\nquantity = "crest"\nmost = nan', "most is a number"),
        ('[[limit]]\nchannel = "roof"\nquantity = "crest"\nmost = true', "most is a number"),
        ('[[limit]]\nchannel = "roof"\nquantity = "crest"\nmoost = 3', "did you mean 'most'"),
        ('[[limit]]\nchannel = "roof"\nquantity = "crest"\nmost = 3\nunit = 1', "unit is a text"),
        ('[[limit]]\nchannel = "rof"\nquantity = "crest"\nmost = 3', "did you mean 'roof'"),
        (
            '[[limit]]\nchannel = "roof"\nquantity = "velocity_rms"\nmost = 3',
            "unit of velocity_rms",
        ),
        (
            '[[limit]]\nchannel = "roof"\nquantity = "velocity_rms"\nmost = 3\nunit = "g"',
            "is one of m_s, cm_s, mm_s",
        ),
        ('[[limit]]\nchannel = "*"\nquantity = "normalised_rms"\nmost = 3', "no figure normalised"),
        ('[[limit]]\nchannel = "*"\nquantity = "zone"\nmost = "B"', "--machine"),
        ('[[limit]]\nchannel = "*"\nquantity = "zone"\nmost = "E"', "one of A, B, C"),
        ('[[limit]]\nchannel = "*"\nquantity = "zone"\nleast_fall_pct = 3', "no fall in per cent"),
        ('[[limit]]\nchannel = "*"\nquantity = "third_octave_rms"\nmost = 3', "band_Hz goes with"),
        (
            '[[limit]]\nchannel = "*"\nquantity = "crest"\nmost = 3\nband_Hz = 3',
            "band_Hz goes with",
        ),
        (
            '[[limit]]\nchannel = "*"\nquantity = "third_octave_rms"\nmost = 3\nband_Hz = 21',
            "no band of 21 Hz; there are",
        ),
    ],
)
def test_a_wrong_limit_is_refused(report, tmp_path: Path, text: str, said: str) -> None:
    halved(tmp_path)
    (tmp_path / "limits.toml").write_text(text)
    before = sorted(tmp_path.iterdir())
    result = report("b.csv", "a.csv", "--limits", "limits.toml", "--out", "page.html")
    assert result.returncode == 2 and result.stdout == "" and sorted(tmp_path.iterdir()) == before
    lines = [one for one in result.stderr.splitlines() if not one.startswith("[")]
    assert len(lines) == 1 and said in lines[0] and "limits.toml" in lines[0]


# What comes out


def test_the_summary_stands_first_and_says_how_sure_it_is(report, tmp_path: Path) -> None:
    halved(tmp_path)
    result = report("b.csv", "a.csv", "--channel", "roof", "--out", "out")
    assert result.returncode == 0, result.stderr
    headline = re.search(r"RMS acceleration of roof fell by 50 % \((\d+) to (\d+)\)", result.stdout)
    assert headline and int(headline[1]) <= 50 <= int(headline[2])
    page = (tmp_path / "out/report.html").read_text()
    assert page.index(headline[0]) < page.index("<table")
    write_csv(tmp_path / "b2.csv", {"roof_m_s2": noise(5)})
    assert "did not change for sure" in report("b.csv", "b2.csv", "--out", "out").stdout


def test_the_page_stands_alone_and_hostile_names_are_text(report, tmp_path: Path) -> None:
    hostile = "<script>alert(1)</script>"
    for name, seed in (("b.csv", 1), ("a.csv", 2)):
        write_csv(tmp_path / name, {f"{hostile}_g": noise(seed)})
    assert report("b.csv", "a.csv", "--title", hostile, "--out", "page.html").returncode == 0
    page = (tmp_path / "page.html").read_text()
    assert "<script" not in page and page.count("&lt;script&gt;alert(") >= 5
    assert not re.search(r'(?:src|href)="(?!#)', page) and "@import" not in page
    assert "@page { size: A4" in page and page.count("<svg") == 4
    assert sorted(one.name for one in tmp_path.iterdir()) == ["a.csv", "b.csv", "page.html"]
    for name in ("b.csv", "a.csv"):
        assert hashlib.sha256((tmp_path / name).read_bytes()).hexdigest() in page


def test_another_input_is_told_and_allowed_for(report, tmp_path: Path) -> None:
    """The structure the same, the input doubled."""
    for name, seed, size in (("b.csv", 1, 1.0), ("a.csv", 2, 2.0)):
        base = noise(seed, size)
        roof = signal.lfilter([0.3], [1.0, -1.2, 0.9], base)
        write_csv(tmp_path / name, {"base_m_s2": base, "roof_m_s2": roof})
    result = report("b.csv", "a.csv", "--reference", "base", *REPORT)
    found = figures(result.stdout, "roof")
    assert found["acceleration_rms"]["ratio"] == pytest.approx(2.0, rel=0.1)
    assert found["normalised_rms"]["ratio"] == pytest.approx(1.0, rel=0.02)
    doubts = " ".join(json.loads(result.stdout)["doubts"])
    told = re.search(r"the input differs: RMS of base after is (\d+) %", doubts)
    assert told and abs(int(told[1]) - 200) < 5
    peak = json.loads(result.stdout)["channels"][0]["transmissibility"]["before"]["peak"]
    freq_Hz, response = signal.freqz([0.3], [1.0, -1.2, 0.9], 4096, fs=200.0)
    assert peak["freq_Hz"] == pytest.approx(freq_Hz[np.argmax(np.abs(response))], abs=0.5)
    assert peak["h1"] == pytest.approx(np.abs(response).max(), rel=0.02)


@pytest.mark.slow
def test_felt_acceleration_and_zones_are_on_request(report, tmp_path: Path) -> None:
    halved(tmp_path)
    plain = figures(report("b.csv", "a.csv", "--channel", "roof", *REPORT).stdout)
    assert not {"weighted_rms", "zone_velocity_rms"} & plain.keys()
    words = ("--channel", "roof", "--comfort", "--machine", "medium:rigid")
    found = figures(report("b.csv", "a.csv", *words, *REPORT).stdout)
    assert 0.1 < found["weighted_rms"]["before"] < plain["acceleration_rms"]["before"]
    slow = figures(report("b.csv", "a.csv", *words, "--slow", *REPORT).stdout)
    assert slow["zone_velocity_rms"]["before"] > 1.3 * found["zone_velocity_rms"]["before"]


def test_slow_is_refused_without_a_machine(report, tmp_path: Path) -> None:
    halved(tmp_path)
    result = report("b.csv", "a.csv", "--slow")
    assert result.returncode == 2 and result.stdout == ""
    assert result.stderr.splitlines()[-1].endswith("name it, too: --machine")


def test_json_is_what_its_page_says(report, tmp_path: Path) -> None:
    """Every key is in docs/reference/report-files.md."""
    halved(tmp_path)
    limits(tmp_path, 'channel = "*"\nquantity = "crest"\nmost = 9')
    words = ("--reference", "floor", "--machine", "large:rigid", "--limits", "limits.toml")
    result = report("b.csv", "a.csv", *words, "--json", "--out", "out")
    data = json.loads(result.stdout)
    assert data == json.loads((tmp_path / "out/report.json").read_text())
    page = (ROOT / "docs/reference/report-files.md").read_text()
    free = {"facts", "parameters"}  # whose keys are names

    def keys(found: object) -> set[str]:
        if isinstance(found, list):
            return set().union(*map(keys, found[:3]))
        if not isinstance(found, dict):
            return set()
        inner = (keys(value) for key, value in found.items() if key not in free)
        return set(found).union(*inner)

    missing = [key for key in keys(data) if f"`{key}`" not in page]
    assert not missing
    named = {one["quantity"] for one in data["channels"][0]["figures"]}
    assert not [name for name in named if f"`{name}`" not in page]


# From the bench, and from a real sensor


@pytest.mark.slow
def test_the_example_of_the_page_is_what_comes_out(
    report, tmp_path: Path, build: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    page = (ROOT / "docs/howto/report-before-and-after.md").read_text()
    example = re.search(r"bench gives both.*?```sh\n(.*?)```\s*```text\n(.*?)```", page, re.DOTALL)
    assert example
    printed = ""
    for line in example[1].splitlines():
        assert main(line.split()[1:]) == 0
        printed = capsys.readouterr().out
    assert printed.startswith(example[2])


def bench_log(bench: Bench, folder: Path, law: str, file: str) -> np.ndarray:
    """A closed loop, recorded as a controller streams its samples; what its sensor saw, counts."""
    scenario = str(ROOT / "sim_hil/data/scenarios/random_4_22Hz.toml")
    trace_file = folder / f"{law}.trace"
    bench.call("run", "--scenario", scenario, "--law", law, "--trace", str(trace_file))
    counts = read_trace(trace_file)["accel_counts"]
    settings = {**effective_params(bench, [f"law={law}"])}
    record(folder / file, configuration_frames(settings) + sample_frames(counts))
    return counts


def test_control_off_and_on_by_the_recorder(report, tmp_path: Path, build: Path) -> None:
    bench = Bench()
    off = bench_log(bench, tmp_path, "off", "off.mf4")
    on = bench_log(bench, tmp_path, "fuzzy", "on.mf4")
    result = report("off.mf4", "on.mf4", "--band", "2", "100", *REPORT)
    assert result.returncode == 0, result.stderr
    found = figures(result.stdout)["acceleration_rms"]
    # By another road: scipy's filters forth and back over the counts, ends left out.
    sos = signal.butter(4, [2.0, 100.0], "bandpass", fs=1000.0, output="sos")
    expected = [np.std(signal.sosfiltfilt(sos, one)[1000:-1000]) for one in (off, on)]
    assert found["ratio"] == pytest.approx(expected[1] / expected[0], rel=0.01)
    scale_m_s2 = 1e-9 * effective_params(bench, [])["accel_scale_nm_s2"]
    assert found["before"] == pytest.approx(scale_m_s2 * expected[0], rel=0.01)
    data = json.loads(result.stdout)
    assert [one["name"] for one in data["changed_parameters"]] == ["law"]
    hashes = [one["facts"]["parameters' hash"] for one in data["files"].values()]
    assert hashes[0] != hashes[1]
    assert "Parameters of the controller that differ" in (tmp_path / "page.html").read_text()


@pytest.mark.slow
def test_traces_of_the_bench_say_the_same_as_its_log(report, tmp_path: Path, build: Path) -> None:
    bench = Bench()
    for law in ("off", "fuzzy"):
        bench_log(bench, tmp_path, law, f"{law}.log")
    words = ("--band", "2", "100", *REPORT)
    logged = figures(report("off.log", "fuzzy.log", *words).stdout)["acceleration_rms"]
    channel = ("--channel", "a5_mm_s2")
    traced = figures(report("off.trace", "fuzzy.trace", *channel, *words).stdout)
    assert traced["acceleration_rms"]["ratio"] == pytest.approx(logged["ratio"], rel=0.01)


@pytest.mark.slow
def test_two_recordings_of_a_controller_on_a_bus(report, tmp_path: Path, capsys) -> None:
    """The whole road: the firmware's node, its raw stream over SLCAN, the recorder, the report. Its
    sensor sees 8 Hz with an amplitude of 20000 counts, and noise of four."""
    controller = Controller(build_peer(tmp_path), tmp_path)
    controller.start()
    try:
        for name in ("b.mf4", "a.mf4"):
            words = ("record", "--out", name, "--raw", "--seconds", "5", "--bus", controller.bus)
            assert main(["can", *words]) == 0
    finally:
        controller.stop()
    capsys.readouterr()
    result = report("b.mf4", "a.mf4", "--band", "4", "100", *REPORT)
    assert result.returncode == 0, result.stderr
    found = figures(result.stdout)
    scale_nm_s2 = next(one["default"] for one in parameters() if one["name"] == "accel_scale_nm_s2")
    expected_m_s2 = 20_000 / np.sqrt(2.0) * 1e-9 * scale_nm_s2
    # Butterworth's high-pass at 4 Hz takes 0.2 % at 8 Hz.
    assert found["acceleration_rms"]["before"] == pytest.approx(expected_m_s2, rel=0.005)
    assert found["acceleration_rms"]["ratio"] == pytest.approx(1.0, abs=0.002)
    data = json.loads(result.stdout)
    assert data["changed_parameters"] == []
    assert "parameters" in data["files"]["after"]["facts"]


@pytest.mark.skipif(not MEASURED.is_dir(), reason=f"{MEASURED} is not there")
def test_a_real_sensor_beside_a_better_one(report, tmp_path: Path) -> None:
    """A shaker's sweep, cut in two: a MEMS accelerometer and a piezo on one table. RMS differs from
    half to half with the sweep; under one input it does not, and their ratio is near 1."""
    file = MEASURED / "shaker_sweep_0_11hz_100sps.csv"
    names = ["mems_pkg_g", "ref_piezo_g"]
    both = read_recording(file, names, "t_s")
    ends = ((2.0, "highpass"), (11.0, "lowpass"))
    sos = np.vstack([signal.butter(4, *end, fs=100.0, output="sos") for end in ends])
    rms_m_s2 = []
    for name, part in (("b.csv", slice(9000, 13000)), ("a.csv", slice(13000, 18000))):
        columns = {one: both.columns[one][part] for one in names}
        write_csv(tmp_path / name, columns, rate_Hz=100.0)
        filtered = signal.sosfilt(sos, columns["mems_pkg_g"])[100:-100]
        rms_m_s2.append(9.80665 * np.std(filtered))
    words = ("--reference", "ref_piezo", "--band", "2", "11", *REPORT)
    result = report("b.csv", "a.csv", *words)
    assert result.returncode == 0, result.stderr
    found = figures(result.stdout, "mems_pkg")
    for side, expected in zip(("before", "after"), rms_m_s2, strict=True):
        assert found["acceleration_rms"][side] == pytest.approx(expected, rel=0.01)
    assert found["acceleration_rms"]["ratio"] > 1.5
    assert found["normalised_rms"]["low"] <= 1.0 <= found["normalised_rms"]["high"]
    data = json.loads(result.stdout)
    for side in ("before", "after"):
        peak = data["channels"][0]["transmissibility"][side]["peak"]
        assert 1.0 < peak["h1"] < 1.2
    assert any("the input differs" in line for line in data["doubts"])
    assert any("not stationary" in line for line in data["channels"][0]["doubts"])
