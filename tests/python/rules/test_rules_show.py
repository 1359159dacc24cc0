"""`quiesce rules show`: files written, rules told, a run's visits counted."""

import csv
import json
from pathlib import Path

import numpy as np
import pytest
from conftest import ROOT
from matplotlib import image
from quiesce.base.errors import UsageError
from quiesce.rules.formats.files import read_system
from quiesce.rules.model import WEIGHTED_MAX, Rule
from quiesce.rules.system.reference import evaluate
from quiesce.rules.views.plots import near
from quiesce.rules.views.rule_text import rules_text
from quiesce.rules.views.subject import rule_line, values_of
from quiesce.rules.views.surface import evaluate_slice, even_points, make_slice, panels
from quiesce.rules.views.visits import Visits, fired_rules, read_visits, visited_cells
from rule_examples import random_base, reference_base

SINGLETON = ROOT / "tools/benchmarks/rules/reference_singleton.fcl"
SYSTEMS = ROOT / "tests/unit/firmware/systems"
CENTROID = ROOT / "tools/benchmarks/rules/reference_centroid.fcl"
OUTPUTS = ("index.html", "memberships.png", "memberships.svg", "surface_I.png", "surface_I.svg")

ONE_INPUT = """FUNCTION_BLOCK one
VAR_INPUT x : REAL; END_VAR
VAR_OUTPUT y : REAL; END_VAR
FUZZIFY x
    TERM low := (0, 1) (4, 0);
    TERM high := (6, 0) (10, 1);
    RANGE := (0 .. 10);
END_FUZZIFY
DEFUZZIFY y
    TERM a := 1; TERM b := 3;
    METHOD : COGS; ACCU : MAX; DEFAULT := 0; RANGE := (0 .. 4);
END_DEFUZZIFY
RULEBLOCK r
    AND : MIN; ACT : MIN;
    RULE 1 : IF x IS low THEN y IS a;
    RULE 2 : IF x IS high THEN y IS b;
END_RULEBLOCK
END_FUNCTION_BLOCK
"""


def write_run(file: Path, columns: dict[str, list[float]]) -> Path:
    with file.open("w", newline="") as stream:
        writer = csv.writer(stream)
        writer.writerow(columns)
        writer.writerows(zip(*columns.values(), strict=True))
    return file


def telemetry(file: Path) -> Path:
    """4 rows at 2 Hz and 1 m/s2, 4 at 20 Hz and 18 m/s2, 2 not valid."""
    return write_run(
        file,
        {
            "t_s": [0.01 * i for i in range(10)],
            "freq_uHz": [2e6] * 4 + [20e6] * 4 + [10e6] * 2,
            "rms_um_s2": [1e6] * 4 + [18e6] * 4 + [8e6] * 2,
            "freq_is_valid": [1] * 8 + [0] * 2,
        },
    )


# The command


@pytest.mark.slow
@pytest.mark.parametrize("file", [SINGLETON, CENTROID])
def test_show_writes_its_pictures(quiesce, tmp_path: Path, file: Path) -> None:
    result = quiesce("rules", "show", file, "--out", "out")
    assert result.returncode == 0, result.stderr
    assert sorted(path.name for path in (tmp_path / "out").iterdir()) == sorted(OUTPUTS)
    for name in OUTPUTS:
        assert f"out/{name}" in result.stdout
    surface = image.imread(tmp_path / "out/surface_I.png")
    assert surface.shape[0] > 400 and surface.shape[1] > 1000
    # Many colours: a surface is there, not an empty frame.
    assert len(np.unique((surface[..., :3] * 255).astype(int).reshape(-1, 3), axis=0)) > 100
    page = (tmp_path / "out/index.html").read_text()
    assert page.count("<svg") == 2
    assert "http://" not in page and "https://" not in page


@pytest.mark.slow
def test_show_prints_the_rules_as_a_matrix(quiesce) -> None:
    lines = quiesce("rules", "show", SINGLETON, "--out", "out").stdout.splitlines()
    head = next(i for i, line in enumerate(lines) if line.startswith("f \\ a"))
    assert lines[head].split()[3:] == ["S", "M", "H", "VH"]
    rows = [line.split() for line in lines[head + 2 : head + 6]]
    assert rows == [
        ["S", "Z", "S", "M", "L"],
        ["M", "S", "M", "L", "L"],
        ["H", "S", "M", "L", "VL"],
        ["VH", "M", "L", "VL", "VL"],
    ]
    assert any("Z 0, S 1.25, M 2.5, L 3.75, VL 5" in line for line in lines)


@pytest.mark.slow
def test_show_counts_the_rules_of_a_run(quiesce, tmp_path: Path) -> None:
    file = telemetry(tmp_path / "run.csv")
    result = quiesce("rules", "show", SINGLETON, "--run", file, "--out", "out", "--json")
    told = json.loads(result.stdout)
    assert told["run"] == {"name": "run.csv", "rows": 10, "counted": 8}
    fired = {rule["rule"]: rule["fired_pct"] for rule in told["rules"]}
    assert {rule: share for rule, share in fired.items() if share} == {1: 50.0, 16: 50.0}
    assert told["rules"][0]["strongest_pct"] == 50.0
    assert told["rules"][0]["mean_strength"] == 1.0


@pytest.mark.slow
def test_show_tells_what_a_run_visited(quiesce, tmp_path: Path) -> None:
    file = telemetry(tmp_path / "run.csv")
    result = quiesce("rules", "show", SINGLETON, "--run", file, "--out", "out")
    assert "8 of 10 rows (frequency valid): f 2 .. 20, a 1 .. 18" in result.stdout
    assert "14 rules never fired" in result.stdout
    assert "Rules that fired" in (tmp_path / "out/index.html").read_text()


@pytest.mark.slow
def test_visits_change_the_picture(quiesce, tmp_path: Path) -> None:
    file = telemetry(tmp_path / "run.csv")
    quiesce("rules", "show", SINGLETON, "--out", "plain")
    quiesce("rules", "show", SINGLETON, "--run", file, "--out", "visited")
    plain, visited = (tmp_path / f / "surface_I.svg" for f in ("plain", "visited"))
    assert "#d55e00" in visited.read_text() and "#d55e00" not in plain.read_text()


@pytest.mark.slow
def test_show_runs_a_scenario(quiesce) -> None:
    result = quiesce("rules", "show", SINGLETON, "--run", "step_10_20Hz", "--out", "out", "--json")
    told = json.loads(result.stdout)
    assert told["run"]["name"] == "step_10_20Hz" and told["run"]["counted"] > 5000
    fired = {rule["text"]: rule["fired_pct"] for rule in told["rules"]}
    # 10 Hz lies between M and H, 20 Hz in VH; the vibration is weak.
    assert fired["f IS VH AND a IS S THEN I IS M"] == pytest.approx(64, abs=5)
    assert fired["f IS M AND a IS S THEN I IS S"] == pytest.approx(36, abs=5)
    assert fired["f IS S AND a IS S THEN I IS Z"] == 0


def test_show_of_one_input_and_its_gap(quiesce, tmp_path: Path) -> None:
    (tmp_path / "one.fcl").write_text(ONE_INPUT)
    write_run(tmp_path / "run.csv", {"rpm": [0.0, 100.0, 500.0, 1000.0]})
    result = quiesce(
        "rules", "show", "one.fcl", "--run", "run.csv", "--column", "x=rpm*0.01", "--out", "o"
    )
    assert result.returncode == 0, result.stderr
    assert "4 rows: x 0 .. 10" in result.stdout
    assert "   1  x IS low THEN y IS a" in result.stdout
    assert "50.0 %" in result.stdout and "25.0 %" in result.stdout
    assert (tmp_path / "o/surface_y.svg").read_text().count("<path") > 10


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["none.fcl"], ["none.fcl"]),
        ([SINGLETON, "--axes", "speed"], ["no input 'speed'", "f, a"]),
        ([SINGLETON, "--axes", "f,f"], ["different inputs"]),
        ([SINGLETON, "--axes", "f", "--at", "f=3"], ["--at f", "cannot be held"]),
        ([SINGLETON, "--at", "a=high"], ["--at a=high", "NAME=VALUE"]),
        ([SINGLETON, "--at", "a=21"], ["--at a=21", "0 .. 20"]),
        ([SINGLETON, "--column", "f=x"], ["--run"]),
        ([SINGLETON, "--run", "none.csv"], ["none.csv", "No such file"]),
        ([SINGLETON, "--run", "short.csv"], ["short.csv", "'f'", "--column f=COLUMN*SCALE"]),
        ([SINGLETON, "--run", "short.csv", "--column", "f=y"], ["no column 'y'", "x"]),
        ([SINGLETON, "--run", "short.csv", "--column", "f=x*no"], ["'no' is not a number"]),
        ([SINGLETON, "--run", "short.csv", "--column", "f=x*0"], ["other than 0"]),
        ([SINGLETON, "--run", "short.csv", "--column", "f"], ["INPUT=COLUMN"]),
        ([SINGLETON, "--run", "short.csv", "--column", "b=x"], ["no input 'b'"]),
        ([SINGLETON, "--run", "brace.csv"], ["brace.csv", "trace"]),
        ([SINGLETON, "--run", "binary.csv"], ["binary.csv", "CSV"]),
        ([SINGLETON, "--run", "silent.csv"], ["silent.csv", "freq_is_valid"]),
        ([SINGLETON, "--run", "step_10_20Hz", "--column", "f=x"], ["--column", "scenario"]),
        (["one.fcl", "--run", "step_10_20Hz"], ["1 inputs", "--column"]),
    ],
)
def test_show_refuses(refused, tmp_path: Path, options, words) -> None:
    (tmp_path / "one.fcl").write_text(ONE_INPUT)
    write_run(tmp_path / "short.csv", {"x": [1.0, 2.0, 3.0]})
    (tmp_path / "brace.csv").write_text("{ not a trace\n1,2\n")
    (tmp_path / "binary.csv").write_bytes(b"\xff\xfe\x00\x80" * 20)
    silent = {"freq_uHz": [1.0] * 3, "rms_um_s2": [1.0] * 3, "freq_is_valid": [0.0] * 3}
    write_run(tmp_path / "silent.csv", silent)
    message = refused("rules", "show", *options, "--out", "out")
    for word in words:
        assert word in message


# Systems of any kind, and more than two inputs


@pytest.mark.slow
@pytest.mark.parametrize(("name", "size"), [("tsukamoto.fis", 1), ("eight.fll", 9)])
def test_show_of_a_system(quiesce, tmp_path: Path, name: str, size: int) -> None:
    result = quiesce("rules", "show", SYSTEMS / name, "--out", "out")
    assert result.returncode == 0, result.stderr
    assert result.stderr.startswith("taken: a system of any kind, as ")
    system = read_system(SYSTEMS / name)
    for output in system.outputs:
        picture = image.imread(tmp_path / f"out/surface_{output.name}.png")
        assert len(np.unique((picture[..., :3] * 255).astype(int).reshape(-1, 3), axis=0)) > 50
    page = (tmp_path / "out/index.html").read_text()
    assert page.count("<svg") == len(system.outputs) + 1
    assert ("at its ends and in its middle" in page) == (size > 1)
    assert rule_line(system, 0) in result.stdout


def test_show_of_a_system_of_one_input_is_a_curve(quiesce, tmp_path: Path) -> None:
    text = ONE_INPUT.replace("AND : MIN", "AND : PROD").replace("IF x IS low", "IF x IS very low")
    (tmp_path / "one.fcl").write_text(text)
    result = quiesce("rules", "show", "one.fcl", "--out", "o", "--json")
    assert result.returncode == 0, result.stderr
    told = json.loads(result.stdout)
    assert told["rules"][0] == {"rule": 1, "text": "x IS very low THEN y IS a"}
    assert (tmp_path / "o/surface_y.svg").read_text().count("<path") > 10


def test_show_of_a_system_counts_rules_of_a_run(quiesce, tmp_path: Path) -> None:
    text = ONE_INPUT.replace("IF x IS low", "IF x IS very low")
    (tmp_path / "one.fcl").write_text(text)
    write_run(tmp_path / "run.csv", {"x": [0.0, 2.0, 5.0, 10.0]})
    result = quiesce("rules", "show", "one.fcl", "--run", "run.csv", "--out", "o", "--json")
    rules = json.loads(result.stdout)["rules"]
    assert [one["fired_pct"] for one in rules] == [50.0, 25.0]
    assert rules[0]["mean_strength"] == pytest.approx((1.0 + 0.25) / 2)


def test_panels_are_the_base_at_ends_and_middles() -> None:
    base = random_base(3, WEIGHTED_MAX, input_count=4)
    cut = make_slice(base, ["x0", "x1"], [])
    assert cut.free == (2, 3) and cut.fixed_text(base) == ""
    rows = panels(base, cut)
    assert [[one.held[2] for one in row] for row in rows] == [[-1.0, 1.0, 3.0]] * 3
    assert [row[0].held[3] for row in rows] == [3.0, 1.0, -1.0]
    assert all(one.free == () and one.axes == (0, 1) for row in rows for one in row)
    held = make_slice(base, ["x0", "x1"], ["x2=0.5"])
    assert held.free == (3,) and held.fixed_text(base) == "x2 = 0.5"
    assert [len(row) for row in panels(base, held)] == [3]
    assert panels(base, make_slice(base, ["x0"], []))[0][0].held == cut.held


def test_a_slice_of_a_system_is_its_reference() -> None:
    system = read_system(SYSTEMS / "gaussians.fll")
    cut = make_slice(system, ["a", "f"], [])
    points = [even_points(system.inputs[1], 7), even_points(system.inputs[0], 5)]
    found = evaluate_slice(system, cut, points).outputs[0]
    a, f = np.meshgrid(*points, indexing="ij")
    wanted = evaluate(system, [f.ravel(), a.ravel()]).outputs[0]
    assert np.array_equal(found.ravel(), wanted) and found.shape == (7, 5)


def test_visits_stand_in_the_panel_that_is_nearest() -> None:
    base = random_base(3, WEIGHTED_MAX, input_count=3)
    x2 = np.array([-0.9, -0.1, 0.6, 1.4, 2.9, 7.0])
    visits = Visits("run", np.stack([np.ones(6), np.ones(6), x2]), 6, "")
    cut = make_slice(base, [], [])
    found = [near(base, cut, one, visits).inputs[2].tolist() for one in panels(base, cut)[0]]
    assert found == [[-0.9, -0.1], [0.6, 1.4], [2.9, 7.0]]


def test_values_that_depend_on_something_have_their_reach() -> None:
    system = read_system(SYSTEMS / "gaussians.fll")
    found = {term.name: values_of(system, term) for term in system.outputs[0].terms}
    assert found["VL"] == (5.0, 5.0)
    assert found["M"] == pytest.approx((2.5 - 0.02 * 25, 2.5 + 0.1 * 20))


# What is behind it


def test_slice_takes_the_first_two_and_the_middle() -> None:
    base = random_base(3, WEIGHTED_MAX, input_count=4)
    cut = make_slice(base, [], ["x1=2.5"])
    assert cut.axes == (0, 2) and cut.held[1] == 2.5 and cut.held[3] == 1.0
    assert cut.text(base) == "x1 = 2.5, x3 = 1"
    with pytest.raises(UsageError, match="one or two"):
        make_slice(base, ["x0", "x1", "x2"], [])


def test_slice_is_the_base_at_the_held_values() -> None:
    base = random_base(3, "centroid", input_count=3)
    cut = make_slice(base, ["x2", "x0"], ["x1=0.25"])
    points = [even_points(base.inputs[2], 7), even_points(base.inputs[0], 5)]
    answer = evaluate_slice(base, cut, points)
    # Axes keep the order that was asked for.
    assert answer.outputs.shape == (1, 7, 5)
    swapped = evaluate_slice(base, make_slice(base, ["x0", "x2"], ["x1=0.25"]), points[::-1])
    assert np.array_equal(answer.outputs[0], swapped.outputs[0].T)


def test_columns_of_the_inputs_own_names(tmp_path: Path) -> None:
    file = write_run(tmp_path / "run.csv", {"a": [1, 2, 3], "f": [4, 5, 6]})
    visits = read_visits(reference_base(), file, [])
    assert visits.inputs.tolist() == [[4, 5, 6], [1, 2, 3]] and visits.condition == ""
    scaled = read_visits(reference_base(), file, ["f=a*10"])
    assert scaled.inputs.tolist() == [[10, 20, 30], [1, 2, 3]]


def test_visited_cells_hold_all_rows_and_clamp() -> None:
    inputs = np.array([[-5.0, 0.1, 12.5, 99.0], [1.0, 1.05, 10.0, 20.0]])
    places, share = visited_cells(reference_base(), Visits("run", inputs, 4, ""), (0, 1))
    assert places[0] == pytest.approx([0.125, 12.625, 24.875])
    assert places[1] == pytest.approx([1.1, 10.1, 19.9])
    assert share.tolist() == [0.5, 0.25, 0.25]


def test_fired_counts_strength_above_0() -> None:
    inputs = np.array([[3.0, 4.0, 5.5, 8.0], [0.0, 0.0, 0.0, 0.0]])
    fired = fired_rules(reference_base(), Visits("run", inputs, 4, ""))
    assert (fired[0].share, fired[0].strongest) == (0.75, 0.75)
    assert fired[0].mean_strength == pytest.approx((1.0 + 0.8 + 0.5) / 3)
    assert (fired[4].share, fired[4].strongest) == (0.75, 0.5)  # f IS M
    assert fired[15].share == 0.0 and fired[15].mean_strength == 0.0


def test_rules_that_fit_no_matrix_are_listed() -> None:
    base = reference_base()
    extra = Rule(base.rules[0].conditions, (4,), "or", 0.5)
    again = Rule(base.rules[0].conditions, (3,), weight=0.25)
    text = rules_text(type(base)(base.name, base.inputs, base.outputs, (*base.rules, extra, again)))
    assert "Z/L*0.25" in text
    assert "  17  f IS S OR a IS S THEN I IS VL WITH 0.5" in text
