"""On-line adaptation: a stream with a change, an adaptive model and frozen ones."""

import json
import tomllib
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from damper_actions import act, refused
from damper_files import text_of
from learned_data import sine
from quiesce.base.errors import UsageError
from quiesce.cli.identify import online as cli_online
from quiesce.damper.data.record import Record
from quiesce.damper.learned.self_tuning import Rates
from quiesce.damper.model_file import read_model
from quiesce.damper.online import (
    ADAPTIVE,
    LAST_FORCE,
    RATES,
    STOPPED,
    Followed,
    Stream,
    adapted,
    follow,
    stream_of,
    trailing,
    untrained,
)
from quiesce.damper.task import Plan

pytestmark = pytest.mark.usefixtures("build")

RATE_Hz = 200.0
SETTLE_s = 0.5


def sine_test(current_A: float, cycles: float = 6.0) -> Record:
    return sine(2.5, 5e-3, current_A, cycles, rate_Hz=RATE_Hz)


def csv(*tests: Record) -> str:
    rows, first_s = [], 0.0
    for one in tests:
        columns = (first_s + one.time_s, 1e3 * one.disp_m, one.force_N, one.command)
        rows += [tuple(map(float, row)) for row in zip(*columns, strict=True)]
        first_s = rows[-1][0] + 1.0 / one.rate_Hz
    return text_of(rows)


@pytest.fixture
def recording(tmp_path: Path) -> Path:
    """0.5 A, then 1.5 A."""
    file = tmp_path / "rig.csv"
    file.write_text(csv(sine_test(0.5), sine_test(1.5)), encoding="utf-8")
    return file


@pytest.fixture(scope="module")
def found(build: Path) -> Followed:
    """The same two tests."""
    stream = stream_of([sine_test(0.5), sine_test(1.5)], None, SETTLE_s)
    return follow(stream, Plan(["bingham"], quick=True, jobs=1), SETTLE_s)


# The stream


def test_change_is_where_the_second_test_begins_or_the_command_leaves_its_level() -> None:
    two = [sine_test(0.5), sine_test(1.5)]
    assert stream_of(two, None, SETTLE_s).change == len(two[0])
    joined = replace(two[0], command=np.where(two[0].time_s < 1.3, 0.5, 0.9))
    assert stream_of([joined], None, SETTLE_s).change == 260
    assert stream_of([joined], 1.2, SETTLE_s).change == 240


def test_what_precedes_the_change_holds_no_row_after_it() -> None:
    two = (sine_test(0.5), sine_test(1.5))
    assert [len(one) for one in Stream(two, 250).before()] == [250]
    assert [len(one) for one in Stream(two, len(two[0]) + 40).before()] == [len(two[0]), 40]


@pytest.mark.parametrize(
    ("change_s", "settle_s", "what"),
    [
        (0.2, 0.5, "at least 1 s"),
        (4.7, 0.5, "nothing is left"),
        (9.0, 0.5, "nothing is left"),
        (2.0, 0.0, "--settle-s 0: less than a row, 0.005 s"),
        (2.0, 0.002, "--settle-s 0.002: less than a row"),
    ],
)
def test_change_without_room_is_refused(change_s: float, settle_s: float, what: str) -> None:
    with pytest.raises(UsageError, match=what):
        stream_of([sine_test(0.5), sine_test(1.5)], change_s, settle_s)


def test_one_test_without_a_change_and_two_rates_are_refused() -> None:
    with pytest.raises(UsageError, match="where is the change"):
        stream_of([sine_test(0.5)], None, SETTLE_s)
    with pytest.raises(UsageError, match="200 and 500 Hz"):
        stream_of([sine_test(0.5), sine(2.5, 5e-3, 0.5)], None, SETTLE_s)


def test_trailing_sums_what_lies_in_the_window() -> None:
    assert trailing(np.arange(6.0), 3) == pytest.approx([0, 1, 3, 6, 9, 12])
    assert trailing(np.ones(3), 10) == pytest.approx([1, 2, 3])


# The models


def test_force_of_a_row_knows_nothing_of_that_row_or_later() -> None:
    stream = stream_of([sine_test(0.5), sine_test(1.5)], None, SETTLE_s)
    row = stream.change + 7
    later = [replace(one, force_N=one.force_N.copy()) for one in stream.records]
    later[1].force_N[7:] = 1e4
    changed = Stream(tuple(later), stream.change)
    forces = [
        adapted(untrained(one.before()), one, RATES, 0, print)[0] for one in (stream, changed)
    ]
    assert np.array_equal(forces[0][: row + 1], forces[1][: row + 1])
    assert not np.array_equal(forces[0][row + 1 :], forces[1][row + 1 :])


def test_model_that_does_not_adapt_is_the_frozen_one() -> None:
    stream = stream_of([sine_test(0.5), sine_test(1.5)], None, SETTLE_s)
    model = untrained(stream.before())
    force_N, kept = adapted(model, stream, Rates(0.0, 0.0, 0.0), 10, print)
    fresh = untrained(stream.before())
    sample = [float(stream.column(name)[50]) for name in ("disp_m", "velocity_m_s", "command")]
    assert force_N[50] == fresh.force_N(*sample) == kept.force_N(*sample)


def test_adaptation_follows_a_change_of_the_current_that_frozen_models_miss(
    found: Followed,
) -> None:
    errors = found.errors_pct()
    assert set(errors) == {ADAPTIVE, "bingham", STOPPED, LAST_FORCE}
    assert errors["bingham"]["before"] < 15.0 < 40.0 < errors["bingham"]["after"]
    assert errors[ADAPTIVE]["after"] < 0.6 * errors["bingham"]["after"]
    assert found.over_best_frozen() == pytest.approx(
        errors[ADAPTIVE]["after"] / min(errors[one]["after"] for one in ("bingham", STOPPED))
    )
    rows = found.parts()["after"]
    force_N = found.stream.column("force_N")[rows]
    expected = np.linalg.norm(force_N - found.adaptive_N[rows]) / np.linalg.norm(force_N)
    assert errors[ADAPTIVE]["after"] == pytest.approx(100.0 * expected)


def test_model_that_diverges_has_an_infinite_error_and_is_not_the_best(found: Followed) -> None:
    lost_N = np.full(len(found.stream), np.nan)
    broken = replace(found, frozen_N={**found.frozen_N, "x": lost_N})
    assert broken.errors_pct()["x"]["after"] == np.inf and broken.best_frozen() != "x"


# Command line


def test_command_writes_page_and_model_and_tells_numbers(
    recording: Path, tmp_path: Path, capsys
) -> None:
    out = tmp_path / "out"
    beside = Path(__file__).resolve().parents[3] / "sim_hil/data/dampers/rd1005_kwok_tanh.toml"
    options = ("--settle-s", "0.5", "--model", "bingham", "--beside", beside, "--out", out)
    assert act(cli_online, recording, *options, "--json") == 0
    found = json.loads(capsys.readouterr().out)
    assert found["change_s"] == pytest.approx(2.405) and found["rows"] == 962
    assert found["models"]["rd1005_kwok_tanh.toml"]["kind"] == "only looked at"
    assert found["models"]["rd1005_kwok_tanh.toml"]["error_pct"]["after"] < 10.0
    assert found["online_over_best_frozen"] < 0.6
    assert len(found["error_over_time"]["time_s"]) == len(found["error_over_time"][ADAPTIVE])
    page = (out / "online.html").read_text(encoding="utf-8")
    assert page.count("<figure") == 3 and "bingham" in page
    assert tomllib.loads((out / "adapted.toml").read_text(encoding="utf-8"))["name"]
    assert read_model(out / "adapted.toml").model == "neuro_fuzzy_stf"


def test_command_tells_errors_as_a_table(recording: Path, capsys) -> None:
    assert act(cli_online, recording, "--settle-s", "0.5", "--model", "bingham") == 0
    said = capsys.readouterr().out
    assert "from 0.5 s on %" in said and "of that of the best frozen one" in said


def test_a_file_beside_may_have_a_fitted_models_name(recording: Path, capsys) -> None:
    dampers = Path(__file__).resolve().parents[3] / "sim_hil/data/dampers"
    text = (dampers / "rd1005_bingham.toml").read_text()
    (recording.parent / "bingham.toml").write_text(text)
    (recording.parent / "b").mkdir()
    (recording.parent / "b/bingham.toml").write_text(text)
    files = [recording.parent / "bingham.toml", recording.parent / "b/bingham.toml"]
    options = ["--settle-s", "0.5", "--model", "bingham", "--json"]
    assert act(cli_online, recording, *options, "--beside", files[0]) == 0
    models = json.loads(capsys.readouterr().out)["models"]
    assert models["bingham"]["kind"] == "frozen at the change"
    assert models["bingham.toml"]["kind"] == "only looked at"
    assert models["bingham"]["error_pct"] != models["bingham.toml"]["error_pct"]
    beside = [word for one in files for word in ("--beside", one)]
    assert act(cli_online, recording, *options, *beside) == 0
    names = list(json.loads(capsys.readouterr().out)["models"])
    assert sum(name.endswith("bingham.toml") for name in names) == 2
    twice = ("--beside", files[0], "--beside", files[0])
    assert "named twice" in refused(cli_online, recording, *options, *twice)


@pytest.mark.parametrize(
    ("options", "what"),
    [
        (("--settle-s", "0"), "--settle-s 0: less than a row"),
        (("--change-s", "99"), "nothing is left"),
        (("--change-s", "-1"), "--change-s"),
        (("--settle-s", "nan"), "--settle-s"),
        (("--model", "nonsense"), "no model 'nonsense'"),
        (("--rates", "0.5,0.1"), "three numbers"),
        (("--rates", "0.5,0.1,9"), "three numbers"),
        (("--beside", "none.toml"), "no such file"),
        (("--train", "part=0,0.5", "--test", "part=0.5,1"), "--change-s"),
    ],
)
def test_bad_options_are_refused_in_one_line(
    recording: Path, options: tuple[str, ...], what: str
) -> None:
    assert what in refused(cli_online, recording, *options)


@pytest.mark.parametrize(
    ("text", "what"),
    [
        ("", "empty"),
        ("time_s,disp_mm\n0,1\n", ""),
        ("t_s,x_mm,force_n,current_a\n0,1,2,0.5\n0.005,x,2,0.5\n", "line 3"),
        ("t_s,x_mm,force_n,current_a\n" + "0,1,2,0.5\n" * 40, ""),
    ],
)
def test_malformed_recording_is_refused_in_one_line(tmp_path: Path, text: str, what: str) -> None:
    file = tmp_path / "bad.csv"
    file.write_text(text, encoding="utf-8")
    message = refused(cli_online, file)
    assert "bad.csv" in message and what in message.replace(":3", " line 3")


def test_missing_recording_is_refused(tmp_path: Path) -> None:
    assert "none.csv" in refused(cli_online, tmp_path / "none.csv")
