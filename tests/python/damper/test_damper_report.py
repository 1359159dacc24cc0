"""The report of an identification: complete, right, and one file that stands alone."""

import json
import math
from collections.abc import Sequence
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest
from damper_actions import dissipative_tanh, two_tones
from quiesce.base.errors import UsageError
from quiesce.damper.band import Band
from quiesce.damper.data.folds import CURRENT, MOTION, QUARTERS
from quiesce.damper.data.record import Record
from quiesce.damper.data.split import Segment, whole
from quiesce.damper.example import EXAMPLE
from quiesce.damper.fit.intervals import Interval
from quiesce.damper.fitted import BLACK_BOX, PARAMETRIC, Fitted
from quiesce.damper.model_file import DamperModel, read_model
from quiesce.damper.passivity import Passivity
from quiesce.damper.plain import plain
from quiesce.damper.ranking import ranked
from quiesce.damper.report.page import write_report
from quiesce.damper.report.plots import errors_by_command, window
from quiesce.damper.report.runs import (
    Run,
    command_parts,
    one_a_level,
    runs_of,
    shown_part,
    whiteness_of,
)
from quiesce.damper.report.tables import (
    band_lines,
    json_report,
    percent,
    ranking_table,
    status_of,
    text_report,
    validation_lines,
    validation_table,
    winners,
)
from quiesce.damper.report.where import course_of, places_of, sentences
from quiesce.damper.score import score
from quiesce.damper.simulate import simulator
from quiesce.damper.store import Store
from quiesce.damper.validation import Blocks, FoldScore

pytestmark = pytest.mark.usefixtures("build")
INTERVALS = [
    Interval("kw_N@0.5A", "N", 425.0, 416.0, 434.0, False),
    Interval("n", "-", 1.0, math.nan, math.nan, True),
    Interval("k_N_m", "N/m", 10.0, -90.0, 110.0, False),
]
TRUTH = replace(EXAMPLE, rig={})


def recorded(current_A: float, seed: int, duration_s: float = 4.0) -> Record:
    """The example damper's force with 1 % noise."""
    record = two_tones(duration_s=duration_s, current_A=current_A)
    force = simulator(TRUTH)(record)
    noise = np.random.default_rng(seed).standard_normal(len(record))
    force = force + 0.01 * np.sqrt(np.mean(force**2)) * noise
    return replace(record, name=f"rig <{current_A:g} A>.csv", force_N=force)


TRAIN_A, TEST_A = (0.0, 0.5, 1.0), (0.25,)


@pytest.fixture(scope="module")
def segments(build) -> tuple[list[Segment], list[Segment]]:
    train = [whole(recorded(level, k)) for k, level in enumerate(TRAIN_A)]
    return train, [whole(recorded(level, 9)) for level in TEST_A]


def fitted(
    name: str, damper: DamperModel, segments, kind: str = PARAMETRIC, **changes
) -> Fitted:  # fmt: skip
    train, test = segments
    simulate = simulator(damper)
    found = score(simulate, train)
    values = {
        "parameter_count": 7,
        "validation_error": found.error,
        "passivity": Passivity(True, 0.0),
        "seconds": 3.2,
        "is_complete": True,
        "intervals": INTERVALS,
        "test": score(simulate, test),
        "notes": ["a <note>"],
    }
    return Fitted(name, f"title of {name}", kind, damper, train=found, **(values | changes))


@pytest.fixture(scope="module")
def models(segments) -> list[Fitted]:
    no = Passivity(False, -0.5)
    return [
        fitted("static", dissipative_tanh(), segments, is_complete=False, intervals=[]),
        fitted("truth", TRUTH, segments),
        fitted("box", TRUTH, segments, BLACK_BOX, parameter_count=300, passivity=no, intervals=[]),
    ]


# Tables


def test_winners_are_the_best_of_each_kind(models) -> None:
    found = {what: one.name for what, one in winners(models).items()}
    assert found == {
        "best": "truth", PARAMETRIC: "truth", "passive": "truth", BLACK_BOX: "box",
    }  # fmt: skip


def test_ranking_says_what_was_cut_short(models) -> None:
    _, rows = ranking_table(models)
    assert [row[1] for row in rows] == ["truth", "box", "static"]
    assert [row[-1] for row in rows] == ["", "", "cut short"]
    assert rows[0][3] == "1.00"


def test_text_has_data_ranking_parameters_and_residual(models, segments) -> None:
    white = whiteness_of(shown_part(runs_of(simulator(models[1].damper), *segments)))
    text = text_report(models, *segments, ["force as in the file"], white)
    for expected in (
        "- force as in the file", "3 test(s), 6000 rows, 12 s, 0, 0.5, 1 A", "held out: 1 test(s)",
        "kw_N@0.5A", "416 .. 434", "at its bound", "hardly known", "white noise", "a <note>",
    ):  # fmt: skip
        assert expected in text
    assert max(len(line) for line in text.splitlines()) < 160


def test_text_of_an_identification_without_result_says_so(segments) -> None:
    train, _ = segments
    assert "no model was fitted" in text_report([], train, [], [])
    assert "--train and --test" in text_report([], train, [], [])


def test_status_of_an_interval() -> None:
    assert [status_of(one) for one in INTERVALS] == ["", "at its bound", "hardly known"]
    assert status_of(Interval("x", "N", 1.0, -math.inf, math.inf, False)) == "not determined"


@pytest.mark.parametrize(
    ("value", "text"),
    [(0.0123, "1.23"), (None, "-"), (math.inf, "diverges"), (math.nan, "-")],
)
def test_error_as_text(value: float | None, text: str) -> None:
    assert percent(value) == text


def test_json_holds_everything_and_is_json(models, segments) -> None:
    report = json_report(models, *segments, ["note"], {"seed": 4, "path": Path("x")})
    again = json.loads(json.dumps(report, allow_nan=False))
    first = again["models"][0]
    assert first["name"] == "truth" and first["damper"]["model"] == "normalised_bouc_wen"
    assert first["intervals"][1]["low"] is None and first["intervals"][1]["at_bound"] is True
    assert first["test"]["tests"][0]["command"] == pytest.approx(0.25)
    assert again["context"] == {"seed": 4, "path": "x"}
    assert len(again["data"]["train"]) == 3


def test_plain_turns_numpy_into_numbers() -> None:
    found = plain({"a": np.float64(1.5), "b": np.arange(2), "c": np.bool_(True), "d": np.inf})
    assert found == {"a": 1.5, "b": [0, 1], "c": True, "d": None}


# Validation


def folds_with(error: float, kinds: Sequence[str] = (CURRENT, MOTION)) -> tuple[FoldScore, ...]:
    squares = tuple(error**2 * (1.0 + 0.1 * k) for k in range(-5, 6))
    return tuple(FoldScore(kind, f"a {kind}", (Blocks(squares, (1.0,) * 11),)) for kind in kinds)


@pytest.fixture(scope="module")
def validated_models(segments) -> list[Fitted]:
    band = Band(0.1, 1.0, 500.0, (CURRENT, MOTION))
    return [
        fitted(name, TRUTH, segments, validation_error=error, folds=folds_with(error), band=band,
               coverage=0.96)
        for name, error in (("worse", 0.2), ("better", 0.1))
    ]  # fmt: skip


def test_report_says_for_which_new_data_errors_stand(validated_models, segments) -> None:
    head, rows = validation_table(validated_models)
    assert head[1:3] == ["new current %", "new motion %"]
    assert rows[0][:3] == ["better", "10.00", "10.00"] and rows[0][-1] == ""
    assert rows[1][0] == "worse" and rows[1][-1] == "100"
    text = text_report(validated_models, *segments, [])
    for expected in (
        "stands for another current between those of the data; left out in turn: a current",
        "better comes before worse in 100 % of 2000 validations",
        "left out (whole currents and whole motions) lie within 50 N of them",
        "of them where the force reaches 500 N, within 5 N where it reaches 50 N",
        "of the held-out rows 96 %",
    ):
        assert expected in text
    first = json_report(validated_models, *segments, [], {})["models"][1]
    assert first["share_first_before"] == pytest.approx(1.0)
    assert first["validation"]["by_kind"] == {
        CURRENT: pytest.approx(0.2),
        MOTION: pytest.approx(0.2),
    }
    assert first["band_95"] == {
        "part": 0.1, "power": 1.0, "scale_N": 500.0, "kinds": ["current", "motion"],
    }  # fmt: skip


def test_flat_band_is_told_in_one_width(validated_models) -> None:
    flat = replace(validated_models[1], band=Band(0.02, 0.0, 500.0, (QUARTERS,)), coverage=None)
    assert band_lines([flat]) == [
        "95 % of the rows that refits of better left out (quarters of every test) lie within 10 N "
        "of them"
    ]
    assert band_lines([replace(flat, band=None)]) == []


def test_quarters_stand_for_no_new_current_and_the_report_says_so(segments) -> None:
    only = fitted("one", TRUTH, segments, folds=folds_with(0.1, [QUARTERS]))
    assert any("nothing whole could be left out" in line for line in validation_lines([only]))


def test_page_shows_validation_by_kind(validated_models, segments, tmp_path: Path) -> None:
    write_report(tmp_path, validated_models[1:], *segments, [], {})
    page = (tmp_path / "report.html").read_text(encoding="utf-8")
    for word in (
        "For which new data",
        "new motion %",
        "where the error is made",
        "95 % of the rows left out",
    ):
        assert word in page


def test_a_model_is_kept_and_read_again_with_its_validation(segments, tmp_path: Path) -> None:
    train, test = segments
    one = fitted("truth", TRUTH, segments, folds=folds_with(0.1),
                 band=Band(0.1, 0.5, 9.0, (MOTION,)), coverage=0.9)  # fmt: skip
    store = Store(tmp_path, "stamp", ["truth"])
    store.keep(one)
    (again,) = store.finished(["truth"], train, test)
    assert (again.folds, again.band, again.coverage) == (one.folds, one.band, one.coverage)
    assert store.keep_best([one])
    assert read_model(tmp_path / "damper.toml").parameters == TRUTH.parameters
    assert not Store(tmp_path / "none", "stamp", []).keep_best([])
    assert not (tmp_path / "none").exists()


@pytest.mark.parametrize(
    ("numbers", "first"),
    [((10, 9), "more"), ((30, 20), "fewer"), ((30, 21), "more")],
)
def test_a_tie_is_for_a_model_that_is_much_smaller(segments, numbers, first: str) -> None:
    """Ten numbers against nine: the one with the less error stays first."""
    more = fitted("more", TRUTH, segments, parameter_count=numbers[0], validation_error=0.100)
    fewer = fitted("fewer", TRUTH, segments, parameter_count=numbers[1], validation_error=0.1015)
    assert ranked([fewer, more])[0].name == first
    assert ranked([replace(fewer, validation_error=0.103), more])[0].name == "more"


# Where


def run_with(error_N: np.ndarray) -> Run:
    record = recorded(0.5, 1, duration_s=8.0)
    return Run(whole(record), True, record.force_N - error_N[: len(record)])


def test_half_a_second_that_makes_the_error_is_told() -> None:
    run = run_with(np.random.default_rng(1).standard_normal(100_000))
    assert sentences([run]) == ["the error is spread evenly over time, speeds and commands"]
    broken = run.model_N.copy()
    rows = round(0.5 * run.rate_Hz)
    broken[-rows:] += 50.0
    (text, *_) = sentences([replace(run, model_N=broken)])
    assert "half of the squared error of rig <0.5 A>.csv is made from 7." in text
    course = course_of(replace(run, model_N=broken))
    assert course.error[-1] > 10.0 * course.error[0] and 4 <= len(course.time_s) <= 40


def test_parts_of_rows_and_error_are_told_by_speed_way_and_command() -> None:
    places = places_of([run_with(np.ones(100_000))])
    assert sum(one.rows for one in places) == pytest.approx(3.0)  # speeds, ways, commands
    assert sum(one.error for one in places) == pytest.approx(3.0)
    for one in places:  # an error that is the same everywhere
        assert one.error == pytest.approx(one.rows)
    slow = run_with(np.ones(100_000))
    part = np.abs(slow.segment.record.velocity_m_s)
    only = np.where(part < 0.1 * part.max(), 5.0, 0.0)
    text = " ".join(sentences([run_with(only)]))
    assert "100 % of the squared error is made at 0 to 10 % of the largest speed" in text


# Runs


def test_runs_are_of_the_scored_rows_after_a_run_from_the_first(segments) -> None:
    record = segments[0][1].record
    simulate = simulator(TRUTH)
    part = Segment(record, 700, 1500)
    run = runs_of(simulate, [], [part])[0]
    assert run.is_test and len(run.model_N) == 800
    assert np.array_equal(run.model_N, simulate(record)[700:1500])
    assert run.error == pytest.approx(score(simulate, [part]).error)


def test_force_goes_through_the_files_average(segments) -> None:
    record = replace(segments[0][1].record, average_samples=9)
    run = runs_of(simulator(TRUTH), [whole(record)], [])[0]
    assert np.array_equal(run.model_N, record.averaged(simulator(TRUTH)(record)))


def test_held_out_runs_are_shown_where_there_are_any(segments) -> None:
    train, test = segments
    assert [run.is_test for run in shown_part(runs_of(simulator(TRUTH), train, test))] == [True]
    assert len(shown_part(runs_of(simulator(TRUTH), train, []))) == 3


def test_one_test_a_level_is_shown() -> None:
    records = [recorded(level, k) for k, level in enumerate([0.0, 0.5, 0.5, 1.0, 1.0])]
    runs = runs_of(simulator(TRUTH), [whole(one) for one in records], [])
    assert [run.label for run in one_a_level(runs)] == ["0 A", "0.5 A", "1 A"]
    assert [run.label for run in one_a_level(runs, most=2)] == ["0 A", "1 A"]


def test_switched_command_is_told_apart_by_its_levels() -> None:
    command = np.repeat([0.0, 0.5, 1.0, 0.0], 500)
    run = runs_of(simulator(TRUTH), [whole(two_tones(current_A=command[:1000]))], [])[0]
    assert [label for label, _ in command_parts(run)] == ["0 A", "0.5 A"]
    wavy = two_tones(current_A=1.0 + np.sin(np.arange(1000) / 50.0))
    parts = command_parts(runs_of(simulator(TRUTH), [whole(wavy)], [])[0])
    assert 2 <= len(parts) <= 4
    assert sum(int(rows.sum()) for _, rows in parts) == 1000


def test_errors_by_command_are_those_of_the_scores(segments) -> None:
    train, test = segments
    damper = dissipative_tanh()
    found = errors_by_command(runs_of(simulator(damper), train, test))
    assert list(found) == ["0 A", "0.5 A", "1 A", "0.25 A, held out"]
    expected = score(simulator(damper), train).segments[1].error
    assert found["0.5 A"] == pytest.approx(100.0 * expected)


def test_window_is_the_most_forceful_stretch() -> None:
    record = two_tones(duration_s=8.0)
    force = np.where(np.arange(4000) > 2500, 100.0, 1.0)
    run = runs_of(lambda one: np.zeros(len(one)), [whole(replace(record, force_N=force))], [])[0]
    assert window(run, 1.0).start >= 2400


def test_white_residual_is_called_white_and_a_missing_term_not(segments) -> None:
    train, _ = segments
    assert whiteness_of(runs_of(simulator(TRUTH), train, [])).is_white
    assert not whiteness_of(runs_of(simulator(dissipative_tanh()), train, [])).is_white
    assert whiteness_of(runs_of(lambda one: np.full(len(one), np.nan), train, [])) is None


# Page


class Tags(HTMLParser):
    """Open tags that never close, and what is shown as text."""

    VOID = frozenset({"meta", "img", "br", "input"})

    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []
        self.images = 0

    def handle_starttag(self, tag: str, attrs: list) -> None:
        self.images += tag == "svg"
        if tag not in self.VOID:
            self.open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag


def test_page_stands_alone_and_escapes_what_users_wrote(models, segments, tmp_path: Path) -> None:
    context = {"title": "<b>rig</b>", "command": "quiesce identify 'a & b.csv'", "files": ["x<y"]}
    write_report(tmp_path / "out", models, *segments, ["<script>alert(1)</script>"], context)
    page = (tmp_path / "out/report.html").read_text(encoding="utf-8")
    tags = Tags()
    tags.feed(page)
    assert tags.open == [] and tags.images == 2 + 4 * 2
    for raw in ("<script", "<b>rig", "rig <0", "a <note>", "x<y", 'src="http'):
        assert raw not in page
    for word in ("Ranking", "95 % interval", "at its bound", "Run it again", "held-out"):
        assert word in page
    numbers = json.loads((tmp_path / "out/report.json").read_text(encoding="utf-8"))
    assert numbers["winners"]["best"] == "truth"
    assert numbers["whiteness"]["is_white"] is True


@pytest.mark.slow
def test_page_without_held_out_rows_says_so(models, segments, tmp_path: Path) -> None:
    train, _ = segments
    write_report(tmp_path, [replace(models[1], test=None)], train, [], [], {})
    assert "held out: nothing" in (tmp_path / "report.html").read_text(encoding="utf-8")


@pytest.mark.slow
def test_model_that_diverges_is_reported_without_plots(segments, tmp_path: Path) -> None:
    record = segments[0][0].record
    beyond = whole(replace(record, velocity_m_s=1e306 * record.velocity_m_s))
    only = fitted("truth", TRUTH, ([beyond], []), test=None, validation_error=math.inf)
    assert math.isinf(only.train.error)
    write_report(tmp_path, [only], [beyond], [], [], {})
    page = (tmp_path / "report.html").read_text(encoding="utf-8")
    assert "The model diverges on this data" in page
    assert json.loads((tmp_path / "report.json").read_text(encoding="utf-8"))["whiteness"] is None


def test_nothing_fitted_is_refused_and_nothing_written(segments, tmp_path: Path) -> None:
    with pytest.raises(UsageError, match="nothing to report"):
        write_report(tmp_path / "out", [], *segments, [], {})
    assert not (tmp_path / "out").exists()


@pytest.mark.slow
def test_same_result_gives_the_same_bytes(models, segments, tmp_path: Path) -> None:
    for name in ("a", "b"):
        write_report(tmp_path / name, models[1:2], *segments, ["n"], {"title": "t"})
    for file in ("report.html", "report.json"):
        assert (tmp_path / "a" / file).read_bytes() == (tmp_path / "b" / file).read_bytes()
