"""Files of every format: read as what they are, refused in one line where they are none."""

import json
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from conftest import run_quiesce
from quiesce.base.errors import UsageError
from quiesce.cli.main import main
from quiesce.recording.open import FORMATS, open_table
from quiesce.recording.write import WRITERS, name_and_unit, time_text, write_columns
from quiesce_benchmarks.campaign import written
from quiesce_benchmarks.campaign.parts.formats import formats_ok, trouble_with
from scipy.io import savemat

RATE_Hz = 200.0
ROWS = 400
TIME_s = np.arange(ROWS) / RATE_Hz
WAVE = np.sin(12.0 * TIME_s)


def refusal(file: Path, *names: str) -> str:
    """The one line of an UsageError, of opening the file or of reading these columns."""
    with pytest.raises(UsageError) as refused:
        open_table(file).numbers(list(names))
    line = str(refused.value)
    assert "\n" not in line and file.name in line
    return line


# By other hands


@pytest.mark.parametrize("name", list(written.WRITERS))
def test_a_file_by_another_hand_is_read(tmp_path: Path, name: str) -> None:
    file, write = written.WRITERS[name]
    write(tmp_path / file, written.recording())
    assert trouble_with(tmp_path / file) == ""


def test_the_figure_counts_formats_that_are_read(monkeypatch: pytest.MonkeyPatch) -> None:
    def wrong(file: Path, columns: written.Columns) -> None:
        written.mat_5(file, {**columns, "force": 1.001 * columns["force"]})

    monkeypatch.setattr(
        "quiesce_benchmarks.campaign.parts.formats.WRITERS",
        {"right": written.WRITERS["MAT 5"], "wrong": ("b.mat", wrong)},
    )
    count, verdicts = formats_ok()
    assert count == 1
    assert [one.is_ok for one in verdicts] == [True, False] and "force" in verdicts[1].trouble


def test_every_format_is_written_by_another_hand() -> None:
    suffixes = {Path(file).suffix for file, _ in written.WRITERS.values()}
    same = {".h5": ".hdf5", ".uff": ".unv", ".mf4": ".mdf"}
    assert suffixes | {same[one] for one in suffixes & set(same)} == {*FORMATS, ".csv"}


# What is in a file beside plain columns


def test_a_matrix_has_a_column_for_each_of_its_columns(tmp_path: Path) -> None:
    savemat(tmp_path / "a.mat", {"data": np.stack([TIME_s, WAVE], axis=1), "rate": 200.0})
    table = open_table(tmp_path / "a.mat")
    assert table.head == ["data_1", "data_2"]
    assert np.array_equal(table.numbers(["data_2"])[1][:, 0], WAVE)


def test_channels_of_two_rates_are_on_the_times_of_the_faster(tmp_path: Path) -> None:
    from asammdf import MDF, Signal

    slow_s = np.arange(21) / 10.0
    with MDF(version="4.10") as mdf:
        mdf.append(Signal(samples=WAVE, timestamps=TIME_s, name="acc", unit="g"))
        mdf.append(Signal(samples=2.0 * slow_s, timestamps=slow_s, name="current", unit="A"))
        mdf.save(tmp_path / "a.mf4")
    table = open_table(tmp_path / "a.mf4")
    _, cells = table.numbers(["time", "acc", "current"])
    assert np.allclose(cells[:, 0], TIME_s) and np.allclose(cells[:, 1], WAVE)
    assert np.allclose(cells[:, 2], 2.0 * TIME_s)
    assert "interpolated straight: current [A]" in table.note


def test_times_of_day_in_parquet_are_seconds(tmp_path: Path) -> None:
    import pandas

    stamps = pandas.Timestamp("2026-01-05") + pandas.to_timedelta(TIME_s, unit="s")
    pandas.DataFrame({"t": stamps, "acc": WAVE}).to_parquet(tmp_path / "a.parquet")
    assert np.allclose(open_table(tmp_path / "a.parquet").numbers(["t"])[1][:, 0], TIME_s)


def test_segments_of_a_labview_file_follow_each_other(tmp_path: Path) -> None:
    columns = written.recording(100)
    file = tmp_path / "a.lvm"
    written.lvm(file, columns)
    text = file.read_text()
    later = {**columns, "time": columns["time"] + 0.2}
    written.lvm(file, later)
    file.write_text(text + "\n" + file.read_text()[file.read_text().index("Channels") :])
    _, cells = open_table(file).numbers(["time", "f"])
    assert np.allclose(cells[:, 0], np.arange(200) / 500.0)


def test_labview_times_from_start_and_step(tmp_path: Path) -> None:
    file = tmp_path / "a.lvm"
    rows = "\n".join(f"\t{value:.6f}" for value in WAVE)
    file.write_text(
        "LabVIEW Measurement\t\nSeparator\tTab\nX_Columns\tNo\n***End_of_Header***\t\n\t\n"
        "Channels\t1\nSamples\t400\nX0\t1.5\nDelta_X\t0.005\n***End_of_Header***\t\n"
        f"X_Value\tacc\tComment\n{rows}\n"
    )
    _, cells = open_table(file).numbers(["time", "acc"])
    assert np.allclose(cells[:, 0], 1.5 + TIME_s) and np.allclose(cells[:, 1], WAVE, atol=1e-6)


# Malformed


@pytest.mark.parametrize("name", [name for name in written.WRITERS if not name.startswith("CSV")])
def test_a_file_that_is_cut_off_is_refused_or_shorter(tmp_path: Path, name: str) -> None:
    """Never a stack trace, and never other values."""
    file, write = written.WRITERS[name]
    whole = written.recording()
    write(tmp_path / file, whole)
    data = (tmp_path / file).read_bytes()
    for part in (0.0, 0.001, 0.02, 0.3, 0.7, 0.98):
        (tmp_path / file).write_bytes(data[: int(part * len(data))])
        try:
            table = open_table(tmp_path / file)
            found = table.numbers(table.head)[1]
        except UsageError as error:
            assert "\n" not in str(error) and file in str(error)
            continue
        for column in found.T:
            assert any(np.allclose(column[:-1], one[: len(column) - 1]) for one in whole.values())


@pytest.mark.parametrize("suffix", list(FORMATS))
@pytest.mark.parametrize(
    "content", [b"", b"t_s,x_mm\n0,1\n", b"\x89PNG\r\n\x1a\n" + bytes(300), bytes(range(256)) * 9]
)
def test_what_is_another_file_is_refused(tmp_path: Path, suffix: str, content: bytes) -> None:
    file = tmp_path / f"a{suffix}"
    file.write_bytes(content)
    assert "export" in refusal(file)


def test_a_file_that_is_not_there_and_a_folder_are_refused(tmp_path: Path) -> None:
    assert "name a recording" in refusal(tmp_path / "none.mat")
    (tmp_path / "folder.mat").mkdir()
    assert "name a recording" in refusal(tmp_path / "folder.mat")


@pytest.mark.parametrize(
    ("values", "words"),
    [
        (np.where(TIME_s == 0.1, np.nan, WAVE), "a.mat:21: column 'x': 'nan'; cut these rows"),
        (np.where(TIME_s == 0.1, np.inf, WAVE), "a.mat:21: column 'x': 'inf'"),
        (1e30 * WAVE, "no measured value"),
        (WAVE + 1j * WAVE, "complex numbers"),
        (np.zeros((4, 5, 6)), "an array of 4 x 5 x 6"),
        (np.array(["one", "two"]), "no numbers"),
        (WAVE[:-1], "399 values where t has 400"),
    ],
)
def test_a_column_that_is_no_use_is_refused(tmp_path: Path, values, words: str) -> None:
    savemat(tmp_path / "a.mat", {"t": TIME_s, "x": values, "y": WAVE})
    assert words in refusal(tmp_path / "a.mat", "t", "x")
    assert len(open_table(tmp_path / "a.mat").numbers(["t", "y"])[0]) == ROWS


def test_a_column_that_is_missing_is_named(tmp_path: Path) -> None:
    savemat(tmp_path / "a.mat", {"t": TIME_s, "x": WAVE})
    assert "no column is named 'f'; there are: t, x" in refusal(tmp_path / "a.mat", "f")
    savemat(tmp_path / "b.mat", {"note": "hello", "rate": 200.0})
    assert "no columns of numbers" in refusal(tmp_path / "b.mat")


def uff(file: Path, change: Callable[[str], str]) -> Path:
    written.uff_58(file, written.recording(100))
    file.write_text(change(file.read_text()))
    return file


def test_universal_files_of_no_time_histories_are_refused(tmp_path: Path) -> None:
    spectra = uff(tmp_path / "a.uff", lambda text: text.replace("        17 ", "        18 "))
    assert "not against time" in refusal(spectra)
    nodes = uff(tmp_path / "b.uff", lambda text: text.replace("    58\n", "    15\n"))
    assert "no data set 58" in refusal(nodes)


@pytest.mark.parametrize(
    ("library", "name"),
    [
        ("h5py", "HDF5"), ("pyuff", "UFF 58"), ("pyarrow.parquet", "Parquet"),
        ("pymatreader", "MAT 7.3"), ("asammdf", "MDF 4"),
    ],
)  # fmt: skip
def test_an_absent_library_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, library: str, name: str
) -> None:
    file, write = written.WRITERS[name]
    write(tmp_path / file, written.recording(100))
    monkeypatch.setitem(sys.modules, library, None)
    line = refusal_of_extra(tmp_path / file)
    assert "install it" in line and ("'files'" in line or "'mdf'" in line)


def refusal_of_extra(file: Path) -> str:
    with pytest.raises(UsageError) as refused:
        open_table(file)
    return str(refused.value)


# Commands


@pytest.mark.parametrize(
    "words",
    [
        ["identify", "no.csv", "--format", "uff"],
        ["replay", "no.csv", "--column", "a", "--unit", "g", "--format", "uff"],
        ["compare", "--rig", "no.toml", "--format", "uff", "--out", "out"],
        ["record", "no.toml", "--out", "out.UFF"],
        ["sweep", "--simulate", "no.toml", "--out", "out.unv"],
    ],
)
def test_a_format_that_cannot_be_written_is_refused_before_the_work(
    words: list[str], monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Before a file is opened, even."""
    monkeypatch.setitem(sys.modules, "pyuff", None)
    assert main(words) == 2
    assert "a universal file needs the extra 'files'" in capsys.readouterr().err


def identified(folder: Path, *arguments: str | Path) -> dict:
    options = ("--model", "bingham", "--effort", "quick", "--json")
    result = run_quiesce(folder, "identify", *arguments, *options)
    assert result.returncode == 0, result.stderr
    return json.loads(result.stdout)


@pytest.mark.usefixtures("build")
def test_identify_finds_the_same_in_two_formats(tmp_path: Path) -> None:
    columns = written.recording()
    written.mat_5(tmp_path / "rig.mat", columns)
    written.uff_58(tmp_path / "rig.uff", columns)
    of_mat, of_uff = (identified(tmp_path, name) for name in ("rig.mat", "rig.uff"))
    of_mat, of_uff = (
        {one["name"]: one["value"] for one in data["models"][0]["intervals"]}
        for data in (of_mat, of_uff)
    )
    assert of_mat["fc_N"] == pytest.approx(300.0, rel=1e-4)
    assert of_uff == pytest.approx(of_mat, rel=1e-6, abs=1e-6)


def replayed(folder: Path, file: str, *options: str) -> dict:
    result = run_quiesce(folder, "replay", file, "--out", "out", "--json", *options)
    assert result.returncode == 0, result.stderr
    return json.loads(result.stdout)


@pytest.mark.usefixtures("build")
@pytest.mark.parametrize("suffix", list(WRITERS))
def test_a_recording_in_another_format_replays_alike(tmp_path: Path, suffix: str) -> None:
    figures = []
    for name in ("a.csv", f"a{suffix}"):
        made = run_quiesce(
            tmp_path, "record", "step_10_20Hz", "--to-s", "4", "--out", name
        )  # fmt: skip
        assert made.returncode == 0, made.stderr
        figures.append(replayed(tmp_path, name, "--column", "accel_m_s2", "--unit", "m_s2"))
    assert figures[0]["median_freq_Hz"] == pytest.approx(figures[1]["median_freq_Hz"], abs=1e-3)
    assert figures[0]["max_rms_m_s2"] == pytest.approx(figures[1]["max_rms_m_s2"], rel=1e-5)


def test_units_end_the_names_of_columns() -> None:
    assert name_and_unit("floor_accel_m_s2") == ("floor_accel", "m/s2")
    assert name_and_unit("upper_stroke_mm") == ("upper_stroke", "mm")
    assert name_and_unit("count") == ("count", "")


def test_text_has_whole_numbers_as_such_and_nine_digits_of_others(tmp_path: Path) -> None:
    columns = {
        "t_s": np.array([0.0, 0.25]),
        "count": np.array([3, -4]),
        "x_m": np.array([1 / 3, 2]),
    }
    write_columns(tmp_path / "a.csv", columns, {"t_s": time_text})
    assert (tmp_path / "a.csv").read_bytes() == b"t_s,count,x_m\n0,3,0.333333333\n0.25,-4,2\n"


@pytest.mark.parametrize("suffix", list(WRITERS))
def test_whole_numbers_become_numbers_of_other_programs(tmp_path: Path, suffix: str) -> None:
    columns = {"t_s": np.arange(50) / 100.0, "count": np.arange(50) - 7}
    write_columns(tmp_path / f"a{suffix}", columns)
    found = open_table(tmp_path / f"a{suffix}").numbers(["count"])[1]
    assert found[:, 0].tolist() == columns["count"].tolist()


def test_columns_of_other_lengths_are_a_mistake_of_the_caller(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="shorter"):
        write_columns(tmp_path / "a.csv", {"t_s": np.arange(3.0), "x": np.arange(2.0)})
