"""Recordings of dampers to records: columns, units, conditioning, parts; measured files, too."""

import argparse
import tomllib
from pathlib import Path

import numpy as np
import pytest
from damper_files import (
    HEAD,
    ROOT,
    ROWS,
    AMPLITUDE_mm,
    FREQ_Hz,
    RATE_Hz,
    mapped,
    read,
    samples,
    text_of,
)
from quiesce.base.errors import UsageError
from quiesce.cli.identify.data_options import add_data_options
from quiesce.damper.data.condition import odd_samples
from quiesce.damper.data.folds import CURRENT, QUARTERS, folds_of
from quiesce.damper.data.motion import derivatives, free_end_filter, integrated, low_passed
from quiesce.damper.data.record import Record
from quiesce.damper.data.records import Conditioned, records_of_set
from quiesce.damper.data.split import (
    Split,
    levels_of,
    parse_part,
    split_records,
    whole,
)
from quiesce.recording.units import ACCELERATION, FORCE, LENGTH, TIME, VELOCITY, split_name

MEASURED = ROOT.parent / "shared/data"
SCORING = tomllib.loads((ROOT / "tools/benchmarks/dampers/scoring.toml").read_text())
SETS = {one["name"]: one for one in SCORING["set"]}


def measured(name: str) -> Path:
    if not (MEASURED / "mr_damper" / name).exists():
        pytest.skip(f"{MEASURED / 'mr_damper' / name} is not on this machine")
    return MEASURED / "mr_damper" / name


def scored(name: str) -> Conditioned:
    measured(Path(SETS[name]["file"]).name)
    return records_of_set(SETS[name], MEASURED, SCORING["displacement_low_pass_Hz"])


def write(folder: Path, text: str, name: str = "test.csv") -> Path:
    (folder / name).write_bytes(text.encode())
    return folder / name


def said(conditioned: Conditioned, text: str) -> bool:
    return any(text in note for note in conditioned.notes)


# Columns and units


@pytest.mark.parametrize(
    ("name", "units", "stem", "unit"),
    [
        ("t_s", TIME, "t", "s"),
        ("Time (ms)", TIME, "time", "ms"),
        ("x_raw_mm", LENGTH, "x", "mm"),
        ("Stroke [um]", LENGTH, "stroke", "um"),
        ("x/mm", LENGTH, "x", "mm"),
        ("disp_in", LENGTH, "disp", "in"),
        ("v_m_s", VELOCITY, "v", "m_s"),
        ("v_cm/s", VELOCITY, "v", "cm_s"),
        ("Velocity (mm/s)", VELOCITY, "velocity", "mm_s"),
        ("a [m/s^2]", ACCELERATION, "a", "m_s2"),
        ("acc_g", ACCELERATION, "acc", "g"),
        ("Force_kN", FORCE, "force", "kN"),
        ("force lbf", FORCE, "force", "lbf"),
        ("force", FORCE, "force", None),
        ("force_volts", FORCE, "force_volts", None),
    ],
)
def test_unit_comes_from_the_end_of_a_name(name, units, stem, unit) -> None:
    found_stem, found = split_name(name, units)
    assert found_stem == stem
    assert (found.name if found else None) == unit


def test_columns_are_found_and_told(tmp_path: Path) -> None:
    conditioned = read(write(tmp_path, text_of(samples())))
    record = conditioned.records[0]
    assert said(conditioned, "displacement = x_mm (mm), force = force_n (N), current = current_a")
    assert record.rate_Hz == pytest.approx(RATE_Hz) and len(record) == ROWS
    assert record.command_unit == "A" and record.level == 0.5
    assert np.abs(record.disp_m).max() == pytest.approx(1e-3 * AMPLITUDE_mm, rel=1e-3)


@pytest.mark.parametrize(
    ("head", "options", "factor"),
    [
        (("Time [ms]", "Stroke (um)", "Load/kN", "Coil current (mA)"), (), (1e3, 1e3, 1e-3, 1e3)),
        (("a1", "a2", "a3", "a4"),
         ("--time", "a1:us", "--displacement", "a2:in", "--force", "a3:lbf", "--current", "a4:A"),
         (1e6, 1.0 / 25.4, 1.0 / 4.4482216152605, 1.0)),
        (("t_s", "x_mm", "volts", "i_a"), ("--force", "volts:980.665*N"),
         (1.0, 1.0, 1.0 / 980.665, 1.0)),
    ],
)  # fmt: skip
def test_units_scale_to_si(tmp_path: Path, head, options, factor) -> None:
    rows = [[f"{v * f:.9g}" for v, f in zip(row, factor, strict=True)] for row in samples()]
    plain = read(write(tmp_path, text_of(samples()))).records[0]
    other = read(write(tmp_path, text_of(rows, head), "other.csv"), *options).records[0]
    assert other.rate_Hz == pytest.approx(plain.rate_Hz, rel=1e-6)
    assert other.force_N == pytest.approx(plain.force_N, abs=1e-3)
    assert other.disp_m == pytest.approx(plain.disp_m, abs=1e-8)
    assert other.command == pytest.approx(plain.command)


@pytest.mark.parametrize(
    "text",
    [
        text_of(samples(), separator=";"),
        text_of(samples(), separator="\t"),
        text_of(samples(), separator=";").replace(".", ","),
        text_of(samples(), end="\r\n"),
        text_of(samples(), end="\r"),
        "\ufeff" + text_of(samples()),
        "# rig 3, oil at 25 C\n\n" + text_of(samples()),
        text_of(samples()).replace("\n", ",\n"),
        text_of(samples()).replace(",", ", "),
    ],
    ids=["semicolon", "tab", "decimal comma", "CRLF", "CR", "BOM", "comment", "trailing", "blanks"],
)
def test_dialects_give_the_same_record(tmp_path: Path, text: str) -> None:
    plain = read(write(tmp_path, text_of(samples()))).records[0]
    other = read(write(tmp_path, text, "other.csv")).records[0]
    assert np.array_equal(other.force_N, plain.force_N)
    assert np.array_equal(other.disp_m, plain.disp_m)


def test_first_column_behind_a_byte_order_mark_can_be_named(tmp_path: Path) -> None:
    file = write(tmp_path, "\ufeff" + text_of(samples()))
    assert len(read(file, "--time", "t_s").records[0]) == ROWS


def test_lines_above_the_header_are_passed_over_on_request(tmp_path: Path) -> None:
    file = write(tmp_path, "rig 3\noperator\n" + text_of(samples()))
    assert len(read(file, "--skip-lines", "2").records[0]) == ROWS


def test_file_without_time_or_current_takes_them_from_options(tmp_path: Path) -> None:
    rows = [row[1:3] for row in samples()]
    file = write(tmp_path, text_of(rows, HEAD[1:3]))
    conditioned = read(file, "--rate-hz", "200", "--current-a", "0.75")
    assert conditioned.records[0].rate_Hz == 200.0 and conditioned.records[0].level == 0.75
    assert said(conditioned, "rows at 200 Hz as stated") and said(conditioned, "0.75 A")


def test_each_file_gets_its_current(tmp_path: Path) -> None:
    rows = [row[:3] for row in samples()]
    files = [write(tmp_path, text_of(rows, HEAD[:3]), f"{name}.csv") for name in "ab"]
    records = read(files, "--current-a", "0,1.5").records
    assert [record.level for record in records] == [0.0, 1.5]


def test_flipped_force_is_turned_and_told(tmp_path: Path) -> None:
    plain = read(write(tmp_path, text_of(samples()))).records[0]
    file = write(tmp_path, mapped(lambda n, row: (*row[:2], -row[2], row[3])))
    conditioned = read(file, "--flip-force")
    assert np.array_equal(conditioned.records[0].force_N, plain.force_N)
    assert said(conditioned, "sign of the force is turned")


def test_mapping_file_says_the_same_as_the_command_line(tmp_path: Path) -> None:
    file = write(tmp_path, text_of(samples(), ("a", "b", "c", "d")))
    (tmp_path / "map.toml").write_text(
        'columns = { time = "a:s", displacement = { column = "b", unit = "mm", scale = 1.0 }, '
        'force = "c:N", current = "d:A" }\ntrain = { part = [0, 0.5] }\n'
        "test = { part = [0.5, 1] }\nkeep_offset = true\n"
    )
    conditioned = read(file, "--columns", str(tmp_path / "map.toml"))
    assert len(conditioned.records[0]) == ROWS and conditioned.split is not None
    assert not said(conditioned, "mean displacement")
    again = read(file, "--columns", str(tmp_path / "map.toml"), "--force", "c:kgf")
    assert np.ptp(again.records[0].force_N) == pytest.approx(
        9.80665 * np.ptp(conditioned.records[0].force_N)
    )


# Tests in a file


def test_group_makes_a_record_of_each_test(tmp_path: Path) -> None:
    rows = [(level, *row[:3]) for level in (0.0, 0.5, 0.0) for row in samples(100)]
    records = read(write(tmp_path, text_of(rows, ("i_a", *HEAD[:3]))), "--group", "i_a").records
    assert [record.name.split("/")[-1] for record in records] == [
        "test.csv i_a=0.000000", "test.csv i_a=0.500000", "test.csv i_a=0.000000 #2",
    ]  # fmt: skip
    assert [len(record) for record in records] == [100, 100, 100]


def test_split_gaps_makes_records_and_leaves_short_ones_out(tmp_path: Path) -> None:
    lines = text_of(samples()).splitlines()
    kept = lines[:100] + lines[120:130] + lines[150:]
    conditioned = read(write(tmp_path, "\n".join(kept)), "--split-gaps")
    assert [len(record) for record in conditioned.records] == [99, 251]
    assert conditioned.records[1].time_s[0] == pytest.approx(149 / RATE_Hz)
    assert said(conditioned, "10 rows left out")


def test_mapping_file_splits_gaps(tmp_path: Path) -> None:
    lines = text_of(samples()).splitlines()
    file = write(tmp_path, "\n".join(lines[:100] + lines[150:]))
    (tmp_path / "map.toml").write_text("split_gaps = true\n")
    assert len(read(file, "--columns", str(tmp_path / "map.toml")).records) == 2


def test_uneven_samples_are_interpolated_on_request(tmp_path: Path) -> None:
    chance = np.random.default_rng(1)
    time_s = np.sort(np.arange(1200) / 400.0 + chance.uniform(-1.1e-3, 1.1e-3, 1200))
    angle = 2.0 * np.pi * FREQ_Hz * time_s
    table = np.column_stack([time_s, 5.0 * np.sin(angle), 300.0 * np.cos(angle)])
    file = write(tmp_path, text_of(table.tolist(), HEAD[:3]))
    with pytest.raises(UsageError, match="--work-rate-hz"):
        read(file)
    conditioned = read(file, "--work-rate-hz", "400")
    record = conditioned.records[0]
    assert record.rate_Hz == 400.0 and said(conditioned, "uneven time stamps")
    true_m_s = 5e-3 * 2.0 * np.pi * FREQ_Hz * np.cos(2.0 * np.pi * FREQ_Hz * record.time_s)
    assert record.velocity_m_s == pytest.approx(true_m_s, abs=0.01 * true_m_s.max())


def test_work_rate_keeps_every_nth_row_of_the_force(tmp_path: Path) -> None:
    file = write(tmp_path, text_of(samples()))
    full = read(file).records[0]
    half = read(file, "--work-rate-hz", "100").records[0]
    assert np.array_equal(half.force_N, full.force_N[::2])
    assert half.rate_Hz == pytest.approx(100.0) and half.file_rows == pytest.approx(2.0)


def test_long_fast_records_are_thinned_by_themselves(tmp_path: Path) -> None:
    time_s = np.arange(30_000) / 2000.0
    angle = 2.0 * np.pi * FREQ_Hz * time_s
    table = np.column_stack([time_s, 5.0 * np.sin(angle), 300.0 * np.cos(angle)])
    conditioned = read(write(tmp_path, text_of(table.tolist(), HEAD[:3])))
    assert conditioned.records[0].rate_Hz == pytest.approx(1000.0)
    assert said(conditioned, "one row in 2 kept, 1000 Hz")


# Motion


@pytest.mark.parametrize("rate_Hz", [100.0, 200.0, 1000.0, 10_000.0])
@pytest.mark.parametrize("freq_Hz", [0.5, 3.0, 8.0])
def test_derivatives_of_a_rounded_sine_are_accurate(rate_Hz: float, freq_Hz: float) -> None:
    time_s = np.arange(int(6.0 * rate_Hz)) / rate_Hz
    omega = 2.0 * np.pi * freq_Hz
    amplitude_m, step_m = 5e-3, 3e-6
    disp_m = np.round(amplitude_m * np.sin(omega * time_s + 0.3) / step_m) * step_m
    smooth_m = low_passed(disp_m, rate_Hz, 40.0)
    velocity_m_s, accel_m_s2 = derivatives(smooth_m, rate_Hz)
    true_m_s = amplitude_m * omega * np.cos(omega * time_s + 0.3)
    true_m_s2 = -amplitude_m * omega**2 * np.sin(omega * time_s + 0.3)
    edge = len(time_s) // 50
    inner = slice(edge, -edge)
    # Rounding by step_m shakes the velocity by about step_m times the band's 2 pi 40 Hz.
    noise_m_s = 2.0 * np.pi * 40.0 * step_m
    assert np.abs(velocity_m_s - true_m_s)[inner].max() < 2e-3 * true_m_s.max() + noise_m_s
    assert np.abs(smooth_m - disp_m)[inner].max() < 2.0 * step_m
    noise_m_s2 = 2.0 * np.pi * 40.0 * noise_m_s
    for found, true, noise in (
        (velocity_m_s, true_m_s, noise_m_s),
        (accel_m_s2, true_m_s2, noise_m_s2),
    ):
        limit = 1.1 * np.abs(true).max() + noise
        assert np.abs(found[:edge]).max() < limit and np.abs(found[-edge:]).max() < limit
        assert np.abs(found[inner]).max() < limit


def test_derivatives_hold_up_to_a_fifth_of_the_sampling_rate() -> None:
    time_s = np.arange(1000) / 100.0
    omega = 2.0 * np.pi * 20.0
    first, second = derivatives(np.sin(omega * time_s), 100.0)
    inner = slice(100, -100)
    assert np.abs(first - omega * np.cos(omega * time_s))[inner].max() < 2e-3 * omega
    assert np.abs(second + omega**2 * np.sin(omega * time_s))[inner].max() < 0.02 * omega**2


@pytest.mark.parametrize("rate_Hz", [200.0, 1000.0, 8000.0])
def test_low_pass_is_flat_without_delay_and_half_at_the_corner(rate_Hz: float) -> None:
    time_s = np.arange(int(8.0 * rate_Hz)) / rate_Hz
    inner = slice(int(2.0 * rate_Hz), int(6.0 * rate_Hz))
    for freq_Hz, gain in ((1.0, 1.0), (5.0, 1.0), (10.0, 1.0), (40.0, 0.5)):
        wave = np.exp(2j * np.pi * freq_Hz * time_s)
        filtered = low_passed(wave.real, rate_Hz, 40.0) + 1j * low_passed(wave.imag, rate_Hz, 40.0)
        found = np.mean((filtered / wave)[inner])
        assert abs(found - gain) < (2e-4 if gain == 1.0 else 2e-2)
    high = low_passed(np.sin(2.0 * np.pi * 75.0 * time_s), rate_Hz, 40.0)
    assert np.abs(high[inner]).max() < 0.01


def test_filter_leaves_a_cubic_unchanged_up_to_its_ends() -> None:
    x = np.linspace(-1.0, 1.0, 500)
    cubic = 3.0 * x**3 - x**2 + 2.0 * x + 1.0
    assert free_end_filter(cubic, 0.04, 4) == pytest.approx(cubic, abs=1e-6)


def test_offset_and_ramp_of_the_sensor_leave_the_force_alone(tmp_path: Path) -> None:
    shifted = mapped(lambda n, row: (row[0], row[1] - 30.0, row[2] + 100.0, row[3]))
    plain = read(write(tmp_path, text_of(samples()))).records[0]
    file = write(tmp_path, shifted, "shifted.csv")
    record = read(file).records[0]
    assert record.disp_m == pytest.approx(plain.disp_m, abs=1e-9)
    assert record.force_N == pytest.approx(plain.force_N + 100.0)
    assert read(file, "--keep-offset").records[0].disp_m.mean() == pytest.approx(-0.03, rel=1e-3)


def test_displacement_follows_from_velocity_alone(tmp_path: Path) -> None:
    time_s = np.arange(4000) / 200.0
    angle = 2.0 * np.pi * FREQ_Hz * time_s
    table = np.column_stack([time_s, 50.0 * np.cos(angle) + 1.0, 300.0 * np.cos(angle)])
    conditioned = read(write(tmp_path, text_of(table.tolist(), ("t_s", "v_mm_s", "f_n"))))
    record = conditioned.records[0]
    true_m = 0.05 / (2.0 * np.pi * FREQ_Hz) * np.sin(angle)
    inner = slice(400, -400)
    assert record.disp_m[inner] == pytest.approx(true_m[inner], abs=0.01 * true_m.max())
    assert np.abs(record.disp_m).max() < 1.1 * true_m.max()
    assert said(conditioned, "high-pass at 0.2 Hz")


@pytest.mark.parametrize("duration_s", [5.0, 60.0])
def test_integration_has_no_drift(duration_s: float) -> None:
    time_s = np.arange(int(duration_s * 500.0)) / 500.0
    velocity_m_s = 0.05 * np.cos(2.0 * np.pi * 2.0 * time_s) + 0.003
    disp_m = integrated(velocity_m_s, 500.0, 0.2)
    assert np.abs(disp_m).max() < 1.3 * 0.05 / (4.0 * np.pi)


def test_measured_velocity_is_used_only_when_asked(tmp_path: Path) -> None:
    omega = 2.0 * np.pi * FREQ_Hz
    rows = [(*row, 1.05 * 5.0 * omega * np.cos(omega * row[0])) for row in samples()]
    file = write(tmp_path, text_of(rows, (*HEAD, "v_mm_s")))
    plain, used = read(file), read(file, "--use-velocity")
    assert said(plain, "gain 1.05, correlation 1.00; not used") and said(used, "; used")
    assert used.records[0].velocity_m_s.max() == pytest.approx(1.05e-3 * 5.0 * omega, rel=1e-3)
    assert plain.records[0].velocity_m_s.max() == pytest.approx(1e-3 * 5.0 * omega, rel=1e-2)


# Parts


def plain_record(command: np.ndarray, rate_Hz: float = 100.0) -> Record:
    count = len(command)
    zero = np.zeros(count)
    time_s = np.arange(count) / rate_Hz
    return Record("made", rate_Hz, time_s, zero, zero, zero, zero, command, "A")


def test_forms_of_a_split_cut_the_same_rows() -> None:
    record = plain_record(np.ones(400))
    for train, test in (
        ({"time_s": [0.0, 1.0]}, {"time_s": [1.0, 4.0]}),
        ({"part": [0.0, 0.25]}, {"part": [0.25, 1.0]}),
        ({"rows": [0, 100]}, {"rows": [100, 4000]}),
    ):
        spec = Split(parse_part("train", train), parse_part("test", test))
        fit, held = split_records([record], spec)
        assert [(s.first, s.end) for s in (*fit, *held)] == [(0, 100), (100, 400)]


def test_split_by_current_takes_whole_tests() -> None:
    records = [plain_record(np.full(100, level)) for level in (0.0, 0.251, 0.5)]
    spec = Split(
        parse_part("train", {"current_A": [0, 0.5]}), parse_part("test", {"current_A": [0.25]})
    )
    fit, held = split_records(records, spec)
    assert [s.record for s in fit] == [records[0], records[2]] and held[0].record is records[1]


@pytest.mark.parametrize(
    ("train", "test", "hint"),
    [
        ({"part": [0.0, 0.6]}, {"part": [0.5, 1.0]}, "share 10 rows"),
        ({"time_s": [0.0, 0.5]}, {"time_s": [5.0, 6.0]}, "no row lies in the test part"),
        ({"current_A": [3.0]}, {"current_A": [1.0]}, "no row lies in the train part"),
    ],
)
def test_parts_that_are_empty_or_overlap_are_refused(train, test, hint) -> None:
    spec = Split(parse_part("train", train), parse_part("test", test))
    with pytest.raises(UsageError, match=hint):
        split_records([plain_record(np.ones(100))], spec)


def test_rows_of_a_thinned_record_are_those_of_the_file(tmp_path: Path) -> None:
    options = ("--work-rate-hz", "100", "--train", "rows=0,200", "--test", "rows=200,400")
    conditioned = read(write(tmp_path, text_of(samples())), *options)
    fit, held = split_records(conditioned.records, conditioned.split)
    assert [(s.first, s.end) for s in (*fit, *held)] == [(0, 100), (100, 200)]


def test_rows_of_a_record_are_a_record() -> None:
    record = plain_record(np.arange(100.0)).rows(10, 30)
    assert len(record) == 20 and record.command[0] == 10.0 and record.time_s[0] == 0.1


def test_average_is_that_of_the_neighbours() -> None:
    record = Record(*[None] * 2, *[np.zeros(5)] * 6, "A", average_samples=3)
    assert record.averaged(np.array([0.0, 3.0, 6.0, 3.0, 0.0])) == pytest.approx(
        [1.5, 3.0, 4.0, 3.0, 1.5]
    )


@pytest.mark.parametrize(("length", "samples"), [(0.0, 1), (0.4, 1), (4.9, 5), (5.9, 5), (6.7, 7)])
def test_average_has_the_nearest_odd_number_of_samples(length: float, samples: int) -> None:
    assert odd_samples(length, []) == samples


def test_options_do_not_clash_with_those_of_a_command() -> None:
    parser = argparse.ArgumentParser()
    add_data_options(parser.add_argument_group("data"))
    assert "--current-a" in parser.format_help()


# Measured dampers


@pytest.mark.parametrize(
    ("name", "tests", "rate_Hz", "train_rows", "test_rows"),
    [
        ("utfsm_sweep_0A", 1, 1000.0, 6000, 6000),
        ("utfsm_sweep_1A", 1, 1000.0, 6000, 6000),
        ("utfsm_sines", 30, 200.0, None, None),
        ("dyke_switched", 1, 600.96, 7407, 7407),
        ("sano", 1, 200.0, 2000, 1499),
    ],
)
def test_scoring_sets_are_read_as_they_are_defined(
    name: str, tests: int, rate_Hz: float, train_rows: int | None, test_rows: int | None
) -> None:
    conditioned = scored(name)
    assert len(conditioned.records) == tests
    assert conditioned.records[0].rate_Hz == pytest.approx(rate_Hz, rel=1e-4)
    train, test = split_records(conditioned.records, conditioned.split)
    if train_rows:
        assert (sum(map(len, train)), sum(map(len, test))) == (train_rows, test_rows)
    else:
        assert (len(train), len(test)) == (18, 12)
    for record in conditioned.records:
        edge = len(record) // 50
        for values in (record.velocity_m_s, record.accel_m_s2):
            inner = np.abs(values[edge:-edge]).max()
            assert max(np.abs(values[:edge]).max(), np.abs(values[-edge:]).max()) < 1.5 * inner


def test_measured_force_is_as_in_the_file() -> None:
    file = measured("utfsm_raw_sweep_0.0A.csv")
    force_N = np.loadtxt(file, delimiter=",", skiprows=1)[:, 2]
    assert np.array_equal(scored("utfsm_sweep_0A").records[0].force_N, force_N)
    assert np.sqrt(np.mean(force_N**2)) == pytest.approx(140.0, rel=0.02)


def test_measured_sines_get_the_moving_average_of_the_file() -> None:
    records = {record.name.split("csv ")[1]: record for record in scored("utfsm_sines").records}
    assert records["amp_mm=10 freq_hz=1 current_a=0"].average_samples == 21
    assert records["amp_mm=25 freq_hz=0.1 current_a=1"].average_samples == 25
    assert {record.average_samples % 2 for record in records.values()} == {1}
    assert levels_of([whole(record) for record in records.values()]) == [0.0, 0.25, 0.5, 0.75, 1.0]


def test_measured_voltage_is_a_switched_command() -> None:
    record = scored("dyke_switched").records[0]
    assert record.command_unit == "V" and record.level is None
    assert {one.kind for one in folds_of([whole(record)])} == {QUARTERS}


def test_measured_opposite_force_is_refused_with_the_hint() -> None:
    with pytest.raises(UsageError, match="--flip-force"):
        read(measured("sano_keio_mrdamper.csv"))


@pytest.mark.parametrize(
    ("name", "hint"),
    [
        ("utfpr_shaketable_16tests.csv", "16 tests one after the other; --group test_id"),
        ("utfsm_raw_sine_5mm3hz.csv", "5 tests one after the other; --group current_a"),
        ("utfsm_sine_30tests.csv", "30 tests .*; --group amp_mm,freq_hz,current_a"),
    ],
)
def test_measured_files_of_several_tests_are_refused_with_the_columns(name, hint) -> None:
    with pytest.raises(UsageError, match=hint):
        read(measured(name))


def test_measured_shaking_table_is_read_by_its_columns() -> None:
    options = ("--group", "test_id", "--command", "coil_v_inferred:V")
    conditioned = read(measured("utfpr_shaketable_16tests.csv"), *options)
    records = conditioned.records
    assert len(records) == 16 and {len(record) for record in records} == {1501}
    levels = levels_of([whole(record) for record in records])
    assert levels == pytest.approx([0.0, 0.8712, 1.98, 3.212])
    kinds = [one.kind for one in folds_of([whole(record) for record in records])]
    assert kinds.count(CURRENT) == 2 and QUARTERS not in kinds
