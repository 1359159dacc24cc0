"""`quiesce rules diff`: differences in words, the largest one and its place, exit codes."""

import dataclasses
import json
from pathlib import Path

import numpy as np
import pytest
from conftest import ROOT
from quiesce.rules.model import (
    METHODS,
    WEIGHTED_MAX,
    WEIGHTED_SUM,
    FuzzySet,
    Rule,
    RuleBase,
    Singleton,
    triangle,
)
from quiesce.rules.reference import evaluate
from quiesce.rules.views.compare import Grid, compare_outputs, make_grid, matched
from quiesce.rules.views.structure import structural_differences
from rule_examples import one_input_base, random_base, reference_base

SINGLETON = ROOT / "tools/benchmarks/rules/reference_singleton.fcl"
CENTROID = ROOT / "tools/benchmarks/rules/reference_centroid.fcl"
TEXT = SINGLETON.read_text()


def changed(folder: Path, name: str, *replacements: tuple[str, str]) -> Path:
    """A copy of the reference controller with its text changed."""
    text = TEXT
    for old, new in replacements:
        assert old in text
        text = text.replace(old, new)
    (folder / name).write_text(text)
    return folder / name


def reordered(base: RuleBase) -> RuleBase:
    """Inputs swapped, rules backwards, sets backwards: the same meaning."""
    inputs = tuple(
        dataclasses.replace(variable, sets=variable.sets[::-1]) for variable in base.inputs[::-1]
    )
    rules = tuple(
        dataclasses.replace(
            rule,
            conditions=tuple(
                dataclasses.replace(
                    c, input=1 - c.input, set=len(base.inputs[c.input].sets) - 1 - c.set
                )
                for c in rule.conditions
            ),
        )
        for rule in base.rules[::-1]
    )
    return dataclasses.replace(base, inputs=inputs, rules=rules)


# The command


@pytest.mark.slow
def test_a_file_and_itself_are_the_same(quiesce, tmp_path: Path) -> None:
    result = quiesce("rules", "diff", SINGLETON, SINGLETON, "--out", "out")
    assert result.returncode == 0, result.stderr
    assert "they say the same" in result.stdout and "same meaning" in result.stdout
    names = {file.name for file in (tmp_path / "out").iterdir()}
    assert names == {"index.html", "difference_I.png", "difference_I.svg"}


def test_one_rule_that_differs(quiesce, tmp_path: Path) -> None:
    """Rule 1 stands alone where f <= 3 and a <= 2: there 1.25 against 0."""
    other = changed(tmp_path, "b.fcl", ("a IS S THEN I IS Z", "a IS S THEN I IS S"))
    result = quiesce("rules", "diff", SINGLETON, other, "--out", "out", "--json")
    assert result.returncode == 1, result.stderr
    told = json.loads(result.stdout)
    assert not told["same"]
    assert told["structure"] == ["rule f IS S AND a IS S: I IS Z against I IS S"]
    (output,) = told["outputs"]
    assert (output["largest"], output["a"], output["b"]) == (1.25, 0.0, 1.25)
    assert output["at"]["f"] <= 3 and output["at"]["a"] <= 2
    assert output["threshold"] == 0.005
    # Rule 1 fires where f < 8 and a < 6: 48 of 500.
    assert 100 * 6 / 500 < output["beyond_pct"] < 100 * 48 / 500
    page = (tmp_path / "out/index.html").read_text()
    assert page.count("<svg") == 1 and "I IS Z against I IS S" in page


@pytest.mark.slow
def test_threshold_is_in_the_outputs_unit(quiesce, tmp_path: Path) -> None:
    shifted = changed(tmp_path, "b.fcl", ("Z := 0;", "Z := 0.5;"))

    def beyond(threshold: str) -> float:
        options = ["--threshold", threshold, "--out", "out", "--json"]
        told = json.loads(quiesce("rules", "diff", SINGLETON, shifted, *options).stdout)
        return told["outputs"][0]["beyond_pct"]

    # Half an ampere in f <= 3, a <= 2, a grid of 401 x 401 points and a few more.
    assert beyond("0.499") == pytest.approx(100 * 6 / 500, abs=0.1)
    assert beyond("0.5") == 0.0
    assert beyond("0") == pytest.approx(100 * 48 / 500, abs=0.4)


@pytest.mark.slow
def test_the_methods_differ_by_what_is_known(quiesce, tmp_path: Path) -> None:
    """Sum per rule against maximum per term: 0.335 A on this controller."""
    other = changed(tmp_path, "sum.fcl", ("ACCU : MAX", "ACCU : SUM"))
    result = quiesce("rules", "diff", SINGLETON, other, "--out", "out", "--json")
    told = json.loads(result.stdout)
    assert told["structure"] == [
        "output I: method weighted average, max against weighted average, sum"
    ]
    assert told["outputs"][0]["largest"] == pytest.approx(0.335, abs=5e-4)


@pytest.mark.slow
def test_singletons_against_centroid(quiesce) -> None:
    result = quiesce("rules", "diff", SINGLETON, CENTROID, "--out", "out")
    assert result.returncode == 1
    assert "method weighted average, max against centroid" in result.stdout
    assert "term Z 0 against" in result.stdout


@pytest.mark.slow
def test_what_is_written_otherwise_may_mean_the_same(quiesce, tmp_path: Path) -> None:
    """Shoulders without their vertical edges at the ends of the universe."""
    other = changed(tmp_path, "b.fcl", ("(0, 0) (0, 1) (3, 1)", "(3, 1)"))
    result = quiesce("rules", "diff", SINGLETON, other, "--out", "out")
    assert result.returncode == 0, result.stdout
    assert "set S (0, 0) (0, 1) (3, 1) (8, 0) against (3, 1) (8, 0)" in result.stdout
    assert "same meaning" in result.stdout


@pytest.mark.parametrize(
    ("names", "options", "words"),
    [
        (("none.fcl", "b.fcl"), [], ["none.fcl"]),
        (("b.fcl", "none.fcl"), [], ["none.fcl"]),
        (("b.fcl", "broken.fcl"), [], ["broken.fcl:"]),
        (("b.fcl", "named.fcl"), [], ["b.fcl and named.fcl", "inputs f, a against g, a"]),
        (("b.fcl", "output.fcl"), [], ["outputs I against J", "by name"]),
        (("b.fcl", "b.fcl"), ["--threshold", "-1"], ["--threshold", "-1"]),
        (("b.fcl", "b.fcl"), ["--threshold", "much"], ["--threshold", "much"]),
        (("b.fcl", "b.fcl"), ["--at", "f=99"], ["--at f=99", "0 .. 25"]),
        (("b.fcl", "b.fcl"), ["--axes", "z"], ["no input 'z'"]),
    ],
)
def test_diff_refuses(refused, tmp_path: Path, names, options, words) -> None:
    changed(tmp_path, "b.fcl")
    (tmp_path / "broken.fcl").write_text(TEXT[: len(TEXT) // 2])
    renamed = TEXT.replace("f : REAL", "g : REAL").replace("FUZZIFY f", "FUZZIFY g")
    (tmp_path / "named.fcl").write_text(renamed.replace("IF f IS", "IF g IS"))
    output = TEXT.replace("I : REAL", "J : REAL").replace("DEFUZZIFY I", "DEFUZZIFY J")
    (tmp_path / "output.fcl").write_text(output.replace("THEN I IS", "THEN J IS"))
    message = refused("rules", "diff", *names, *options, "--out", "out")
    for word in words:
        assert word in message


# What they say


def test_order_says_nothing() -> None:
    base = reference_base()
    other = matched(base, reordered(base))
    assert [v.name for v in other.inputs] == ["f", "a"]
    assert structural_differences(base, other) == []
    (found,) = compare_outputs(base, other, make_grid(base, other), None)
    assert found.is_same


def test_structure_in_words() -> None:
    base = reference_base()
    f, a = base.inputs
    output = base.outputs[0]
    other = dataclasses.replace(
        base,
        inputs=(
            dataclasses.replace(f, maximum=30.0),
            dataclasses.replace(a, sets=(*a.sets[:3], triangle("XH", 10, 15, 20))),
        ),
        outputs=(
            dataclasses.replace(
                output,
                method=WEIGHTED_SUM,
                default=None,
                terms=(*output.terms[:4], Singleton("VL", 4.5)),
            ),
        ),
        rules=(*base.rules[:-1], dataclasses.replace(base.rules[0], weight=0.5)),
    )
    told = structural_differences(base, other)
    assert "input f: universe 0 .. 25 against 0 .. 30" in told
    assert "input a: set VH is in A only" in told
    assert "input a: set XH is in B only" in told
    assert "output I: method weighted average, max against weighted average, sum" in told
    assert "output I: default 0 against no default" in told
    assert "output I: term VL 5 against 4.5" in told
    assert "rule f IS S AND a IS S: I IS Z WITH 0.5 is in B only" in told
    assert "rule f IS VH AND a IS VH: I IS VL is in A only" in told


def test_points_that_do_not_bend_a_set_do_not_count() -> None:
    sets = (FuzzySet("s", ((2.0, 1.0), (5.0, 0.0))),)
    longer = (FuzzySet("s", ((0.0, 1.0), (2.0, 1.0), (5.0, 0.0), (9.0, 0.0))),)
    one, other = (one_input_base(s, (Singleton("t", 1.0),), WEIGHTED_MAX) for s in (sets, longer))
    assert structural_differences(one, other) == []


# What comes out


@pytest.mark.parametrize("seed", range(18))
def test_a_base_equals_itself(seed: int) -> None:
    base = random_base(seed, METHODS[seed % 3], input_count=1 + seed % 3)
    (found,) = compare_outputs(base, base, make_grid(base, base), None)
    assert (found.largest, found.share_beyond, found.share_default) == (0.0, 0.0, 0.0)


def test_the_largest_difference_is_refined_between_the_points_of_the_grid() -> None:
    sets = (triangle("low", 0, 0, 10), triangle("high", 0, 10, 10))
    terms = (Singleton("0", 0.0), Singleton("10", 10.0))
    one = one_input_base(sets, terms, WEIGHTED_MAX)
    light = Rule(one.rules[0].conditions, (0,), weight=0.5)
    other = dataclasses.replace(one, rules=(light, one.rules[1]))
    (found,) = compare_outputs(one, other, make_grid(one, other), None)
    # u against u / ((1 - u) / 2 + u), u = x / 10: greatest where (1 + u)^2 = 2.
    u = np.sqrt(2) - 1
    assert found.at[0] == pytest.approx(10 * u, abs=1e-3)
    assert found.largest == pytest.approx(10 * (2 * u / (1 + u) - u), abs=1e-9)
    assert found.values == pytest.approx((10 * u, 10 * 2 * u / (1 + u)), abs=1e-2)


def test_points_count_by_the_volume_around_them() -> None:
    grid = Grid((np.array([0.0, 1.0, 10.0]), np.array([0.0, 4.0])))
    expected = np.outer([0.05, 0.5, 0.45], [0.5, 0.5])
    assert grid.weights == pytest.approx(expected) and grid.points == 6


def test_two_without_a_value_are_the_same() -> None:
    base = one_input_base((triangle("s", 0, 0, 5),), (Singleton("t", 4.0),), WEIGHTED_MAX)
    (found,) = compare_outputs(base, base, make_grid(base, base), None)
    assert found.is_same and found.share_beyond == 0


def test_missing_values_and_defaults_are_told() -> None:
    sets = (triangle("s", 0, 0, 5),)
    terms = (Singleton("t", 4.0),)
    silent = one_input_base(sets, terms, WEIGHTED_MAX, default=None)
    spoken = one_input_base(sets, terms, WEIGHTED_MAX, default=4.0)
    (found,) = compare_outputs(silent, spoken, make_grid(silent, spoken), None)
    assert found.largest == np.inf and np.isnan(found.values[0]) and found.values[1] == 4.0
    assert found.share_beyond == pytest.approx(0.5, abs=1e-3)
    wider = one_input_base((triangle("s", 0, 0, 6),), terms, WEIGHTED_MAX, default=4.0)
    (found,) = compare_outputs(spoken, wider, make_grid(spoken, wider), None)
    assert found.is_same and found.share_default == pytest.approx(0.1, abs=1e-3)


@pytest.mark.parametrize("seed", range(20))
def test_no_random_point_exceeds_the_largest_difference(seed: int) -> None:
    one = random_base(seed, METHODS[seed % 3])
    other = dataclasses.replace(
        random_base(seed, METHODS[seed % 3]),
        rules=one.rules[1:] or (dataclasses.replace(one.rules[0], weight=0.3),),
    )
    (found,) = compare_outputs(one, other, make_grid(one, other), None)
    random = np.random.default_rng(seed)
    points = [random.uniform(v.minimum, v.maximum, 20000) for v in one.inputs]
    a, b = (evaluate(base, points).outputs[0] for base in (one, other))
    assert np.abs(b - a).max() <= found.largest + 0.01 * found.range
    share = (np.abs(b - a) > found.threshold).mean()
    assert found.share_beyond == pytest.approx(share, abs=0.02)
