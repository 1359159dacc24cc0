"""Rule files: round trips keep the meaning, and what a format cannot hold is named."""

import itertools
import math
import re
from dataclasses import replace

import numpy as np
import pytest
from quiesce.base.errors import UsageError
from quiesce.rules.formats import files
from quiesce.rules.formats.files import FORMATS, read_text, write_text
from quiesce.rules.formats.same import difference
from quiesce.rules.model import (
    CENTROID,
    METHODS,
    OR,
    WEIGHTED_MAX,
    WEIGHTED_SUM,
    Condition,
    FuzzySet,
    Rule,
    RuleBase,
    Singleton,
    triangle,
)
from quiesce.rules.reference import evaluate
from rule_examples import random_base, reference_base
from rule_files import TANK, random_file_base, with_output


def refusal(base: RuleBase, format: str) -> str:
    with pytest.raises(UsageError) as caught:
        write_text(base, format)
    return str(caught.value)


# Round trips


def grid_of(base: RuleBase, steps: int) -> list[np.ndarray]:
    axes = [np.linspace(v.minimum, v.maximum, steps) for v in base.inputs]
    return [axis.ravel() for axis in np.meshgrid(*axes)]


def assert_same_answers(one: RuleBase, other: RuleBase, steps: int) -> None:
    points = grid_of(one, steps)
    a, b = evaluate(one, points), evaluate(other, points)
    assert np.array_equal(a.is_default, b.is_default)
    np.testing.assert_allclose(a.outputs, b.outputs, rtol=0, atol=1e-12)


def holds(base: RuleBase, format: str) -> bool:
    return format != "fis" or base.outputs[0].method != WEIGHTED_MAX


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("way", list(itertools.permutations(FORMATS)))
def test_reference_controller_survives_every_way(method: str, way: tuple[str, ...]) -> None:
    first = base = reference_base(method)
    for format in way:
        if holds(base, format):
            base = read_text(write_text(base, format), format, "other")
            assert difference(first, base) is None
    assert_same_answers(first, base, 61)


@pytest.mark.parametrize("seed", range(20))
@pytest.mark.parametrize("method", METHODS)
def test_random_base_survives_every_format(method: str, seed: int) -> None:
    first = base = random_file_base(seed, method)
    for format in ("fcl", "fis", "fll", "fcl"):
        if holds(base, format):
            base = read_text(write_text(base, format), format, "other")
            assert difference(first, base) is None
    assert_same_answers(first, base, 9)
    assert base == first


@pytest.mark.parametrize("seed", range(40))
def test_any_points_survive_fcl_and_fll(seed: int) -> None:
    base = replace(random_base(seed, METHODS[seed % 3]), name="any")
    written = 0
    for format in ("fcl", "fll"):
        try:
            text = write_text(base, format)
        except UsageError as error:
            assert re.search(r"0 everywhere|third point", str(error))
            continue
        assert difference(base, read_text(text, format, "other")) is None
        written += 1
    assert written in (0, 2)


def test_numbers_survive_exactly() -> None:
    random = np.random.default_rng(5)
    for exponent in (-25, -9, -4, 0, 5, 16, 25):
        x = sorted((random.uniform(1, 9, 3) * 10.0**exponent).tolist())
        variable = replace(
            TANK.inputs[0], minimum=x[0], maximum=x[2],
            sets=(triangle("low", *x), triangle("high", x[0], x[0], x[1])),
        )  # fmt: skip
        base = replace(TANK, inputs=(variable, TANK.inputs[1]))
        for format in FORMATS:
            assert read_text(write_text(base, format), format, "other") == base


def test_written_twice_is_written_alike() -> None:
    for format in FORMATS:
        text = write_text(TANK, format)
        assert write_text(read_text(text, format, "other"), format) == text


# What a format cannot hold

GAPS = replace(TANK, rules=TANK.rules[:1])  # nothing fires at level 10
CHAIN = FuzzySet("low", ((0.0, 1.0), (2.0, 0.75), (5.0, 0.0)))


def with_set(base: RuleBase, one: FuzzySet) -> RuleBase:
    first = replace(base.inputs[0], sets=(one, *base.inputs[0].sets[1:]))
    return replace(base, inputs=(first, *base.inputs[1:]))


def renamed(base: RuleBase, name: str) -> RuleBase:
    return replace(base, inputs=(replace(base.inputs[0], name=name), *base.inputs[1:]))


def with_rule(base: RuleBase, *conditions: Condition) -> RuleBase:
    return replace(base, rules=(*base.rules, Rule(conditions, (0,))))


@pytest.mark.parametrize(
    ("base", "format", "words"),
    [
        (with_output(TANK, method=WEIGHTED_MAX), "fis", ["greatest strength", "ACCU : SUM"]),
        (with_output(GAPS, default=0.25), "fis", ["valve", "0.5", "0.25", "middle"]),
        (with_output(GAPS, default=None), "fis", ["valve", "none", "middle"]),
        (with_set(TANK, CHAIN), "fis", ["level", "low", "3 points"]),
        (with_set(TANK, FuzzySet("low", ((0.0, 0.5), (5.0, 0.0)))), "fis", ["low", "2 points"]),
        (with_rule(TANK, Condition(0, 0), Condition(0, 1)), "fis", ["rule 3", "level", "twice"]),
        (renamed(TANK, "it's"), "fis", ["it's", "rename"]),
        (renamed(TANK, "  "), "fis", ["rename"]),
        (renamed(TANK, "water level"), "fcl", ["water level", "letters"]),
        (renamed(TANK, "water level"), "fll", ["water level", "letters"]),
        (renamed(TANK, "2nd"), "fcl", ["2nd", "digit"]),
        (renamed(TANK, "term"), "fcl", ["'term' is a word of FCL"]),
        (renamed(TANK, "with"), "fll", ["'with' is a word of FLL"]),
        (renamed(TANK, "VALVE"), "fcl", ["'valve'", "'VALVE'"]),
        (replace(TANK, name="my tank"), "fcl", ["my tank", "rename"]),
        (replace(TANK, name=""), "fll", ["name", "rename"]),
        (replace(TANK, name="a # b"), "fll", ["a # b", "rename"]),
        (with_set(TANK, FuzzySet("low", ((20.0, 0.0), (30.0, 1.0)))), "fcl", ["low", "0 .. 10"]),
        (with_set(TANK, FuzzySet("low", ((5.0, 0.0), (3.0, 1.0)))), "fll", ["ascending"]),
        (with_output(TANK, default=7.0), "fcl", ["default 7", "0 .. 1"]),
        (with_output(TANK, terms=(Singleton("a", 0.0), Singleton("b", 3.0))), "fll", ["3"]),
        (with_output(TANK, terms=(Singleton("a", 0.0), Singleton("a", 1.0))), "fcl", ["again"]),
        (replace(TANK, rules=()), "fcl", ["no rules"]),
        (replace(TANK, rules=TANK.rules * 513), "fll", ["1026 rules", "1024"]),
        (replace(TANK, rules=(Rule((Condition(0, 0),), (1,), weight=1.5),)), "fcl", ["1.5"]),
        (with_rule(TANK, *[Condition(0, 0)] * 9), "fcl", ["9 conditions"]),
        (with_output(TANK, maximum=math.inf), "fcl", ["inf"]),
        (with_output(GAPS, default=math.nan), "fcl", ["default of output valve"]),
        (replace(TANK, rules=(Rule((Condition(0, 0),), (None,)),)), "fcl", ["';'"]),
    ],
)  # fmt: skip
def test_what_a_format_cannot_hold_is_named(base: RuleBase, format: str, words) -> None:
    message = refusal(base, format)
    for word in words:
        assert word in message
    assert "\n" not in message


def test_methods_cannot_be_mixed_in_fis() -> None:
    centroid = reference_base(CENTROID, default=2.5).outputs[0]
    rules = tuple(replace(rule, conclusions=(*rule.conclusions, 1)) for rule in TANK.rules)
    base = replace(TANK, outputs=(*TANK.outputs, centroid), rules=rules)
    assert "one method" in refusal(base, "fis")
    for format in ("fcl", "fll"):
        assert difference(base, read_text(write_text(base, format), format, "x")) is None


def test_fis_takes_a_default_that_no_input_reaches() -> None:
    base = reference_base(WEIGHTED_SUM, default=0.0)
    again = read_text(write_text(base, "fis"), "fis", "x")
    assert again.outputs[0].default == 2.5
    assert_same_answers(base, again, 61)


def test_one_condition_is_written_without_its_connective() -> None:
    base = replace(TANK, rules=(Rule((Condition(0, 0),), (1,), OR),))
    for format in FORMATS:
        assert difference(base, read_text(write_text(base, format), format, "x")) is None


# Comparing


def conditions_swapped(base: RuleBase) -> RuleBase:
    rules = tuple(replace(rule, conditions=rule.conditions[::-1]) for rule in base.rules)
    return replace(base, rules=rules)


@pytest.mark.parametrize(
    ("one", "other", "words"),
    [
        (TANK, replace(TANK, name="pond"), "names tank and pond"),
        (TANK, replace(TANK, inputs=TANK.inputs[:1]), "numbers of variables"),
        (TANK, renamed(TANK, "height"), "input level"),
        (TANK, with_set(TANK, CHAIN), "input level"),
        (TANK, with_output(TANK, method=WEIGHTED_MAX), "output valve"),
        (TANK, with_output(TANK, maximum=2.0), "output valve"),
        (TANK, with_output(TANK, terms=TANK.outputs[0].terms[::-1]), "output valve"),
        (GAPS, with_output(GAPS, default=0.25), "default of output valve"),
        (GAPS, with_output(GAPS, default=None), "default of output valve"),
        (TANK, with_output(TANK, default=0.25), None),
        (TANK, GAPS, "numbers of rules"),
        (TANK, replace(TANK, rules=TANK.rules[::-1]), "rule 1"),
        (TANK, replace(TANK, rules=(TANK.rules[0], replace(TANK.rules[1], weight=0.5))), "rule 2"),
        (TANK, replace(TANK, rules=(TANK.rules[0], replace(TANK.rules[1], connective="and"))),
         "rule 2"),
        (TANK, conditions_swapped(TANK), None),
        (with_set(TANK, FuzzySet("low", ((-1.0, 1.0), (0.0, 1.0), (5.0, 0.0), (6.0, 0.0)))), TANK,
         None),
        (with_set(TANK, FuzzySet("low", ((0.0, 0.0), (0.0, 1.0), (5.0, 0.0)))), TANK,
         "input level"),
    ],
)  # fmt: skip
def test_difference_is_named(one: RuleBase, other: RuleBase, words: str | None) -> None:
    assert difference(one, other) == words
    assert (difference(other, one) is None) == (words is None)


def test_what_a_writer_loses_is_not_written(monkeypatch) -> None:
    whole = write_text(TANK, "fcl")
    monkeypatch.setitem(files.WRITERS, "fcl", lambda base: whole.replace(" WITH 0.75", ""))
    assert "what is lost: rule 1" in refusal(TANK, "fcl")
