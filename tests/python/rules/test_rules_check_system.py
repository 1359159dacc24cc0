"""`quiesce rules check` of systems of any kind: what is proved holds, what is sampled is there."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from conftest import ROOT
from quiesce.cli.main import main
from quiesce.rules.analysis.findings import (
    CONTRADICTORY,
    DISCONTINUOUS,
    DUPLICATE,
    EMPTY,
    NON_MONOTONE,
    PROVED,
    SAMPLED,
    UNCOVERED,
    UNREACHABLE,
    UNUSED,
)
from quiesce.rules.analysis.systems.analyse import Analysis, analyse_system
from quiesce.rules.analysis.systems.jumps import jumps
from quiesce.rules.analysis.systems.reach import reach, why_it_may_jump
from quiesce.rules.analysis.systems.sample import draw, sampled
from quiesce.rules.analysis.systems.signs import (
    MAYBE,
    NO,
    YES,
    Signs,
    normed,
    signs_at,
    signs_between,
)
from quiesce.rules.analysis.systems.support import corners, fires_at, support
from quiesce.rules.engine.precise import compile_precisely
from quiesce.rules.formats.files import read_system
from quiesce.rules.proof.system_walk import walk_system
from quiesce.rules.system.compile import CompiledSystem, compile_system
from quiesce.rules.system.model import System
from quiesce.rules.system.norms import NORMS
from quiesce.rules.system.reference import WEAKEST, evaluate, fired_at
from system_examples import random_curve, random_system

SYSTEMS = ROOT / "tests/unit/firmware/systems"
NUMBERS = range(30)
POINTS = 1500
ROUNDING = 2.0**-40  # what float64 makes of 1 - 1

GAP = """Engine: gap
InputVariable: a
  range: 0 10
  term: lo Triangle 0 1 4
  term: hi Trapezoid 6 8 10 10
  term: out Triangle 20 21 22
InputVariable: b
  range: 0 1
  term: any1 Gaussian 0.5 0.1
OutputVariable: o
  range: 0 4
  aggregation: none
  defuzzifier: WeightedAverage
  default: 0.25
  term: p Constant 1
  term: q Constant 3
  term: r Constant 4
RuleBlock:
  conjunction: AlgebraicProduct
  disjunction: AlgebraicSum
  implication: none
  activation: General
  rule: if a is lo and b is any1 then o is p
  rule: if a is hi and b is any1 then o is q
  rule: if a is hi and b is any1 then o is p with 0
"""


def read(folder: Path, text: str = GAP) -> System:
    file = folder / "gap.fll"
    file.write_text(text)
    return read_system(file)


def of_kind(found: Analysis, kind: str, basis: str) -> list[str]:
    return [one.text for one in found.findings if (one.kind, one.basis) == (kind, basis)]


# ---- what is proved ------------------------------------------------------------------------------


@pytest.mark.parametrize("number", NUMBERS)
def test_signs_are_those_of_float64_at_every_point(number: int) -> None:
    """A point where some rule fires is never called one where none does."""
    system = random_system(number, any_norm=True)
    x = list(draw(system, POINTS))
    signs, (fired, strengths) = fires_at(system, x), fired_at(system, x)
    for above, strength in zip(signs.rules, strengths, strict=True):
        assert not ((np.broadcast_to(above, strength.shape) == NO) & (strength > ROUNDING)).any()
    for above, rules in zip(signs.outputs, fired, strict=True):
        strongest = np.max([one.strength for one in rules], axis=0)
        assert not ((np.broadcast_to(above, strongest.shape) == NO) & (strongest > ROUNDING)).any()


@pytest.mark.parametrize("number", NUMBERS)
def test_cells_hold_what_points_say(number: int) -> None:
    system = random_system(number, any_norm=True)
    proved, x = support(system), draw(system, POINTS)
    strongest = evaluate(system, list(x)).strongest
    _, strengths = fired_at(system, list(x))
    for index in range(len(system.outputs)):
        for region in proved.uncovered[index]:
            inside = region_points(region, system)
            assert not (evaluate(system, inside).strongest[index] > 0.0).any()
        if proved.covered[index]:
            assert (strongest[index] > 0.0).all()
            assert not proved.uncovered[index]
    for rule in proved.silent:
        assert not (strengths[rule] > 0.0).any()


def region_points(region, system: System) -> list[np.ndarray]:
    rng = np.random.default_rng(3)
    return [
        rng.uniform(piece.start + 1e-9 * width, piece.end - 1e-9 * width, 60)
        if (width := piece.end - piece.start) > 0
        else np.full(60, piece.start)
        for piece in region.pieces
    ]


def test_certain_signs_are_many() -> None:
    """Else all of this would say nothing."""
    certain = [
        (np.broadcast_to(above, POINTS) != MAYBE).mean()
        for number in NUMBERS
        for system in [random_system(number)]
        for above in fires_at(system, list(draw(system, POINTS))).rules
    ]
    assert np.mean(certain) > 0.6


@pytest.mark.parametrize("norm", sorted(NORMS))
def test_signs_of_norms(norm: str) -> None:
    """All pairs of 0, a little, nearly 1 and 1."""
    values = np.array([0.0, 0.3, 0.8, 1.0])
    a, b = (one.ravel() for one in np.meshgrid(values, values))
    result = np.minimum(NORMS[norm](a, b), 1.0)
    signs = normed(norm, signs_of_values(a), signs_of_values(b))
    for sign, is_so in ((signs.above_0, result > 0.0), (signs.below_1, result < 1.0)):
        assert not ((sign == YES) & ~is_so).any() and not ((sign == NO) & is_so).any()
        assert (sign != MAYBE).mean() > 0.7


def signs_of_values(mu: np.ndarray) -> Signs:
    return Signs(np.where(mu > 0.0, YES, NO), np.where(mu < 1.0, YES, NO))


def test_signs_of_curves_hold_all_over_an_interval() -> None:
    rng = np.random.default_rng(9)
    for _ in range(300):
        curve = random_curve(rng, 0.0, 10.0)
        at = np.unique([0.0, *curve.knots, *(x for x, _ in curve.points or ()), 10.0])
        at = at[(at >= 0.0) & (at <= 10.0)]
        signs = signs_between(curve, at[:-1], at[1:])
        for k, (start, end) in enumerate(zip(at[:-1], at[1:], strict=True)):
            x = np.linspace(start, end, 101)[1:-1]
            mu = np.clip(curve.function(x), 0.0, 1.0)
            assert not (signs.above_0[k] == NO and (mu > 0.0).any())
            assert not (signs.below_1[k] == NO and (mu < 1.0).any())
            points = signs_at(curve, x)
            assert not ((points.above_0 == YES).any() and signs.above_0[k] == NO)
            assert not ((points.above_0 == NO).any() and signs.above_0[k] == YES)


def test_a_wide_grid_is_proved_input_by_input(tmp_path: Path) -> None:
    more = "".join(
        f"InputVariable: c{k}\n  range: 0 1\n"
        + "".join(f"  term: t{i} Triangle {i / 9} {i / 9 + 0.05} {i / 9 + 0.1}\n" for i in range(9))
        for k in range(4)
    )
    rule = "rule: if a is lo and b is any1"
    text = GAP.replace("OutputVariable", f"{more}OutputVariable")
    text = text.replace(rule, f"{rule} and (c0 is t0 or c1 is t1 or c2 is t2 or c3 is t3)", 1)
    proved = support(read(tmp_path, text))
    assert not proved.is_whole
    assert any(region.text(read(tmp_path, text)) == "a 4 .. 6" for region in proved.uncovered[0])


# ---- findings ------------------------------------------------------------------------------------


def test_a_gap_of_one_input_is_proved_with_its_share(tmp_path: Path) -> None:
    found = analyse_system(read(tmp_path))
    told = of_kind(found, UNCOVERED, PROVED)
    assert "no rule for o fires where a 4 .. 6 (20 % of the inputs): it is its default 0.25" in told
    assert not of_kind(found, UNCOVERED, SAMPLED)
    assert of_kind(found, UNREACHABLE, PROVED) == [
        "rule 3 never fires: a IS hi AND b IS any1 THEN o IS p WITH 0"
    ]
    assert of_kind(found, UNUSED, PROVED) == [
        "no rule asks for out of input a", "no rule concludes r of output o",
    ]  # fmt: skip
    assert of_kind(found, EMPTY, PROVED) == ["out of input a is 0 all over the universe"]
    assert [one[:60] for one in of_kind(found, CONTRADICTORY, PROVED)] == [
        "rule 2 and rule 3 have the same conditions, but conclude o I"
    ]


def test_a_gap_that_signs_cannot_see_is_sampled(tmp_path: Path) -> None:
    """A bounded difference is 0 where both are below a half."""
    text = GAP.replace("AlgebraicProduct", "BoundedDifference").replace("lo Tri", "lo Bell 2 9 1 #")
    found = analyse_system(read(tmp_path, text))
    (told,) = of_kind(found, UNCOVERED, SAMPLED)
    assert "sampled points elsewhere, such as a = " in told


def test_same_conditions_and_conclusions_are_told(tmp_path: Path) -> None:
    text = GAP.replace("then o is p with 0", "then o is q with 0.5")
    (told,) = of_kind(analyse_system(read(tmp_path, text)), DUPLICATE, PROVED)
    assert told.startswith("rule 3 repeats rule 2 for o, both count: ")


def test_jumps_have_their_height_and_place(tmp_path: Path) -> None:
    text = GAP.replace("lo Triangle 0 1 4", "lo Rectangle 0 5").replace(
        "hi Trapezoid 6 8 10 10", "hi Rectangle 5 10"
    )
    system = read(tmp_path, text)
    (jump,) = [one for one in jumps(system).found if one.input == 0]
    assert jump.height == pytest.approx(1.0) and not jump.to_default  # 1, both at 5, then 3
    assert jump.at[0] == pytest.approx(5.0, abs=1e-7)
    (told,) = of_kind(analyse_system(system), DISCONTINUOUS, SAMPLED)
    assert told.startswith("o jumps along a by 1 (25 % of its range), at a = 5")
    assert why_it_may_jump(system, 0, True) == ["hi of a", "lo of a"]


def test_a_steep_slope_is_no_jump(tmp_path: Path) -> None:
    text = GAP.replace("lo Triangle 0 1 4", "lo Ramp 5.001 5").replace(
        "hi Trapezoid 6 8 10 10", "hi Ramp 5 5.001"
    )
    assert not jumps(read(tmp_path, text)).found


@pytest.mark.parametrize("number", [2, 3, 4, 5, 13, 22])
def test_what_is_called_continuous_does_not_jump(number: int) -> None:
    system = random_system(number, any_norm=True)
    proved = support(system)
    jumping = {jump.output for jump in jumps(system).found}
    for index in range(len(system.outputs)):
        if not why_it_may_jump(system, index, proved.covered[index]):
            assert index not in jumping


@pytest.mark.parametrize("number", NUMBERS)
def test_outputs_stay_within_their_reach(number: int) -> None:
    system = random_system(number)
    answer = evaluate(system, list(draw(system, POINTS)))
    for index, one in enumerate(system.outputs):
        bounds = reach(system, index)
        values = answer.outputs[index][~answer.is_default[index]]
        if bounds is not None and values.size:
            slack = 1e-9 * (one.maximum - one.minimum)
            assert bounds[0] - slack <= values.min() and values.max() <= bounds[1] + slack


def test_a_turn_between_two_sets_is_told(tmp_path: Path) -> None:
    text = GAP.replace("lo Triangle 0 1 4", "lo Ramp 8 1\n  term: mid Triangle 3 4 5")
    text = text.replace("then o is p with 0", "then o is r with 0.0001")
    text += "  rule: if a is mid and b is any1 then o is r\n"
    text = text.replace("hi Trapezoid 6 8 10 10", "hi Ramp 1 8")
    found = analyse_system(read(tmp_path, text))
    assert any("o turns back along a" in one for one in of_kind(found, NON_MONOTONE, SAMPLED))


def test_sampled_points_are_at_corners_too(tmp_path: Path) -> None:
    system = read(tmp_path)
    points = sampled(system, 2000)
    for values, variable in zip(points.x, system.inputs, strict=True):
        assert set(corners(variable)) <= set(values.tolist())
    assert 0.2 < points.output_fires[0].mean() < 0.9
    assert not points.rule_fires[2].any()


# ---- integers ------------------------------------------------------------------------------------


def with_wrong_word(compiled: CompiledSystem) -> CompiledSystem:
    """As if float64 had another system: what the walk must see."""
    outputs = compiled.system.outputs
    term = replace(outputs[0].terms[0], value=outputs[0].terms[0].value + 0.5)
    wrong = replace(outputs[0], terms=(term, *outputs[0].terms[1:]))
    return replace(compiled, system=replace(compiled.system, outputs=(wrong, *outputs[1:])))


def test_every_integer_of_a_small_system_is_walked(tmp_path: Path) -> None:
    compiled = compile_system(read(tmp_path), [0.05, 0.01], [0.001])
    walked = walk_system(compiled)
    assert walked.is_complete and walked.points == 201 * 101 + 4
    assert 0 < walked.outputs[0].unit_error < 0.002
    assert walk_system(with_wrong_word(compiled)).outputs[0].unit_error > 0.4


def test_the_search_finds_more_than_random_points() -> None:
    compiled = compile_precisely(read_system(SYSTEMS / "gaussians.fll")).compiled
    quick = walk_system(compiled, is_quick=True)
    (output,) = quick.outputs
    assert not quick.is_complete and output.judged + output.weak + output.defaults <= quick.points
    counts = [
        compiled.input_integer(i, x) for i, x in enumerate(draw(compiled.system, POINTS, seed=77))
    ]
    x = [compiled.input_value(i, n) for i, n in enumerate(counts)]
    strong = evaluate(compiled.system, x).strongest[0] >= WEAKEST
    assert strong.mean() > 0.5
    assert output.most_error < output.unit_error


# ---- the command ---------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "name", ["gaussians.fll", pytest.param("tsukamoto.fis", marks=pytest.mark.slow)]
)
def test_check_says_of_each_line_how_it_is_known(capsys, name: str) -> None:
    assert main(["rules", "check", str(SYSTEMS / name), "--quick"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[0].startswith("kind       a system, no plain rule base: ") and name in lines[0]
    assert lines[-1].split() == ["result", "ok"]
    plain = ("kind", "note", "points", "engine", "arithmetic", "result")
    for line in lines:
        is_told = line.endswith(("[proved]", "[sampled]"))
        assert is_told or line.split()[0] in plain, line


def test_check_reports_json(capsys, tmp_path: Path) -> None:
    read(tmp_path, GAP.replace("hi Trapezoid 6 8", "hi Trapezoid 3 8"))
    command = ["rules", "check", str(tmp_path / "gap.fll"), "--json", "--quick"]
    assert main([*command, "--lsb", "a=0.01"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert told["problems"] == [] and not told["is_complete"]
    assert PROVED in {one["basis"] for one in told["findings"]} <= {PROVED, SAMPLED}
    (output,) = told["outputs"]
    assert output["unit_error"] < 0.01 and len(output["at"]) == 2
    assert {fact["what"] for fact in output["facts"]} == {"coverage", "range", "jumps"}
    assert main([*command, "--max-error", "1e-7"]) == 1
    assert "o is off by" in json.loads(capsys.readouterr().out)["problems"][0]


def test_a_gap_without_a_default_is_an_error(capsys, tmp_path: Path) -> None:
    read(tmp_path, GAP.replace("default: 0.25", "default: nan"))
    assert main(["rules", "check", str(tmp_path / "gap.fll"), "--quick"]) == 1
    out = capsys.readouterr().out
    assert "error      no rule for o fires where a 4 .. 6" in out and "findings are errors" in out


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["--lsb", "z=1"], "NAME one of a, b, o"),
        (["--default", "o=1"], "the file says 0.25"),
        (["--controller"], "AlgebraicProduct, expected 'Minimum'"),
        (["--jobs", "-1"], "--jobs -1"),
        (["--max-error", "-1"], "0 or more"),
    ],
)
def test_bad_options_are_one_line(capsys, tmp_path: Path, options: list[str], words: str) -> None:
    read(tmp_path)
    assert main(["rules", "check", str(tmp_path / "gap.fll"), *options]) == 2
    message = capsys.readouterr().err
    assert words in message and len(message.splitlines()) == 1
