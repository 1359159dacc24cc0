"""Static findings: each kind found where it is, and not where it is not."""

import dataclasses

import numpy as np
import pytest
from quiesce.rules.analysis.analyse import analyse
from quiesce.rules.analysis.coverage import uncovered_regions
from quiesce.rules.analysis.dominance import dominated_rules, outdoes
from quiesce.rules.analysis.findings import (
    CONTRADICTORY,
    DUPLICATE,
    EMPTY,
    ERROR,
    NON_MONOTONE,
    NOTE,
    UNCOVERED,
    UNREACHABLE,
    UNUSED,
    WARNING,
    Finding,
)
from quiesce.rules.analysis.monotone import reversals
from quiesce.rules.model import (
    CENTROID,
    METHODS,
    WEIGHTED_MAX,
    WEIGHTED_SUM,
    Condition,
    FuzzySet,
    Input,
    Output,
    Rule,
    RuleBase,
    Singleton,
    trapezoid,
    triangle,
)
from quiesce.rules.reference import evaluate
from rule_examples import one_input_base, random_base, reference_base


def of_kind(base: RuleBase, kind: str) -> list[Finding]:
    return [finding for finding in analyse(base) if finding.kind == kind]


def with_rules(base: RuleBase, *rules: Rule) -> RuleBase:
    return dataclasses.replace(base, rules=rules)


def without_rule(base: RuleBase, index: int) -> RuleBase:
    return with_rules(base, *base.rules[:index], *base.rules[index + 1 :])


def when(f: int, a: int, term: int, weight: float = 1.0) -> Rule:
    return Rule((Condition(0, f), Condition(1, a)), (term,), weight=weight)


@pytest.mark.parametrize("method", [WEIGHTED_MAX, WEIGHTED_SUM])
def test_the_reference_controller_is_clean(method: str) -> None:
    assert analyse(reference_base(method)) == []


# Uncovered


def test_missing_rule_leaves_its_core_uncovered() -> None:
    """Rule (f S, a S): alone where f <= 3 and a <= 2."""
    (finding,) = of_kind(without_rule(reference_base(), 0), UNCOVERED)
    assert finding.severity == WARNING
    assert finding.place == "f 0 .. 3, a 0 .. 2"
    assert f"{100 * 3 * 2 / (25 * 20):.3g} % of the inputs" in finding.text
    assert "its default 0" in finding.text


def test_uncovered_without_a_default_is_an_error() -> None:
    base = dataclasses.replace(
        without_rule(reference_base(), 0), outputs=reference_base(default=None).outputs
    )
    (finding,) = of_kind(base, UNCOVERED)
    assert finding.severity == ERROR and "no default" in finding.text


def test_a_point_between_sets_is_uncovered_though_it_has_no_width() -> None:
    sets = (triangle("low", 0, 0, 4), triangle("high", 4, 10, 10))
    base = one_input_base(sets, (Singleton("t", 1.0),), WEIGHTED_MAX, default=0.0)
    (finding,) = of_kind(base, UNCOVERED)
    assert finding.place == "x = 4" and "no width" in finding.text
    closed = (triangle("low", 0, 0, 4), triangle("high", 3, 10, 10))
    assert of_kind(one_input_base(closed, (Singleton("t", 1.0),), WEIGHTED_MAX), UNCOVERED) == []


def test_negated_and_or_conditions_cover() -> None:
    not_high = Rule((Condition(0, 1, negated=True),), (0,))
    base = one_input_base(
        (triangle("low", 0, 2, 4), trapezoid("high", 5, 6, 10, 10)),
        (Singleton("t", 1.0),),
        WEIGHTED_MAX,
    )
    (region,) = uncovered_regions(with_rules(base, not_high), 0)
    assert (region.pieces[0].start, region.pieces[0].end) == (6, 10)
    either = Rule((Condition(0, 0), Condition(0, 1)), (0,), "or")
    assert [r.share for r in uncovered_regions(with_rules(base, either), 0)] == [0.1, 0.0]


@pytest.mark.parametrize("seed", range(60))
def test_regions_are_where_the_reference_says_default(seed: int) -> None:
    """Share against counting, and each region's middle."""
    base = random_base(seed, METHODS[seed % 2], input_count=1 + seed % 3)
    regions = uncovered_regions(base, 0)
    random = np.random.default_rng(seed)
    points = [random.uniform(v.minimum, v.maximum, 20000) for v in base.inputs]
    counted = evaluate(base, points).is_default.mean()
    assert sum(region.share for region in regions) == pytest.approx(counted, abs=0.02)
    for region in regions:
        middle = [np.array([(piece.start + piece.end) / 2]) for piece in region.pieces]
        assert evaluate(base, middle).is_default[0, 0]


def test_uncovered_regions_of_many_are_summed_up() -> None:
    sets = tuple(triangle(f"s{i}", i, i + 0.5, i + 1) for i in range(7))
    base = one_input_base(sets, (Singleton("t", 1.0),), WEIGHTED_MAX, default=0.0)
    inputs = (dataclasses.replace(base.inputs[0], sets=sets),) * 2
    base = RuleBase("holes", inputs, base.outputs, base.rules)
    findings = of_kind(base, UNCOVERED)
    assert findings[0].place == "x 7 .. 10" and "30 %" in findings[0].text
    assert len(findings) == 8  # 7 .. 10 and the points 0 .. 6


# Unused


def test_unused_sets_and_terms() -> None:
    base = reference_base()
    rules = [rule for rule in base.rules if rule.conditions[0].set != 2]
    rules = [rule for rule in rules if rule.conclusions != (4,)]
    places = {finding.place for finding in of_kind(with_rules(base, *rules), UNUSED)}
    assert places == {"input f, H", "output I, VL"}


def test_unused_input_and_output() -> None:
    base = reference_base()
    two = dataclasses.replace(base, outputs=base.outputs * 2)
    rules = [Rule((Condition(0, i),), (i, None)) for i in range(4)]
    texts = [finding.text for finding in of_kind(with_rules(two, *rules), UNUSED)]
    assert "no rule asks for input a" in texts
    assert "no rule concludes output I" in texts


def test_term_without_an_area() -> None:
    sets = (triangle("s", 0, 5, 10), triangle("t", 0, 5, 10))
    terms = (triangle("inside", 8, 12, 14), triangle("beyond", 10, 12, 14))
    (finding,) = of_kind(one_input_base(sets, terms, CENTROID), EMPTY)
    assert finding.severity == ERROR and finding.place == "output y, beyond"
    assert of_kind(one_input_base(sets[:1], terms, CENTROID), EMPTY) == []  # no rule concludes it


# Unreachable


def test_rule_that_never_fires() -> None:
    beyond = triangle("beyond", 12, 14, 16)
    base = one_input_base((triangle("s", 0, 5, 10), beyond), (Singleton("t", 1.0),), WEIGHTED_SUM)
    (finding,) = of_kind(base, UNREACHABLE)
    assert finding.place == "rule 2" and "never fires" in finding.text


def test_rule_of_weight_0_never_fires() -> None:
    base = reference_base()
    rules = [*base.rules, when(0, 0, 4, weight=0.0)]
    findings = of_kind(with_rules(base, *rules), UNREACHABLE)
    assert [finding.place for finding in findings] == ["rule 17"]


def test_rule_that_another_one_outdoes() -> None:
    """f IS S says Z wherever f IS S AND a IS S does, and more strongly."""
    base = reference_base()
    rules = [*base.rules, Rule((Condition(0, 0),), (0,))]
    (finding,) = of_kind(with_rules(base, *rules), UNREACHABLE)
    assert finding.place == "rule 1" and "rule 17" in finding.text
    summed = with_rules(reference_base(WEIGHTED_SUM), *rules)
    assert of_kind(summed, UNREACHABLE) == []


def test_a_lighter_rule_does_not_outdo() -> None:
    base = reference_base()
    rules = [*base.rules, Rule((Condition(0, 0),), (0,), weight=0.9)]
    assert dominated_rules(with_rules(base, *rules)) == {}


def test_a_narrower_set_is_outdone_by_a_wider_one() -> None:
    sets = (triangle("narrow", 4, 5, 6), trapezoid("wide", 3, 4.9, 5, 8))
    base = one_input_base(sets, (Singleton("t", 1.0),), WEIGHTED_MAX)
    assert dominated_rules(base) == {0: 1}
    apart = (triangle("narrow", 4, 5, 6), trapezoid("wide", 4.5, 4.9, 5, 8))
    assert dominated_rules(one_input_base(apart, (Singleton("t", 1.0),), WEIGHTED_MAX)) == {}


def test_a_cap_by_other_conditions_counts() -> None:
    """a reaches 0.5 only, so that f's set above 0.5 does not matter."""
    cut = FuzzySet("cut", ((0, 0), (2.5, 0.5), (7.5, 0.5), (10, 0)))
    f = Input("f", 0, 10, (triangle("S", 0, 5, 10), cut))
    output = Output("I", 0, 5, (Singleton("t", 1.0),), WEIGHTED_MAX)
    rules = (Rule((Condition(0, 1),), (0,)), Rule((Condition(0, 0), Condition(1, 0)), (0,)))

    def found(most: float) -> dict[int, int]:
        a = Input("a", 0, 10, (FuzzySet("constant", ((0.0, most),)),))
        return dominated_rules(RuleBase("cap", (f, a), (output,), rules))

    assert found(0.5) == {1: 0}
    assert found(0.6) == {0: 1}  # now the second one is the greater


def test_a_cap_is_met_between_breakpoints() -> None:
    """R: min(x / 10, 0.5). Q, from 0.1 to 0.5, is above it at both ends, but not at x = 5."""
    rising = FuzzySet("rising", ((0, 0), (10, 1)))
    slow = FuzzySet("slow", ((0, 0.1), (10, 0.5)))
    half = Input("a", 0, 10, (FuzzySet("constant", ((0.0, 0.5),)),))
    output = Output("I", 0, 5, (Singleton("t", 1.0),), WEIGHTED_MAX)
    weak = Rule((Condition(0, 0), Condition(1, 0)), (0,))
    strong = Rule((Condition(0, 1),), (0,))

    def slow_outdoes(one: FuzzySet) -> bool:
        base = RuleBase("cap", (Input("f", 0, 10, (rising, one)), half), (output,), (weak, strong))
        return outdoes(base, strong, weak)

    assert not slow_outdoes(slow)
    assert slow_outdoes(FuzzySet("fast", ((0, 0.1), (5, 0.5), (10, 0.5))))


@pytest.mark.parametrize("seed", range(150))
def test_dominated_rules_change_nothing(seed: int) -> None:
    """Strengths on a fine grid: master >= dominated; and no clear master goes unseen."""
    base = random_base(seed, WEIGHTED_MAX, input_count=1 + seed % 2)
    axes = [np.linspace(v.minimum, v.maximum, 401) for v in base.inputs]
    strengths = evaluate(base, np.ix_(*axes), want_strengths=True).strengths
    assert strengths is not None
    found = dominated_rules(base)
    for weak, strong in found.items():
        assert base.rules[weak].conclusions == base.rules[strong].conclusions
        assert (strengths[strong] >= strengths[weak] - 1e-12).all()
    for weak, rule in enumerate(base.rules):
        for strong, other in enumerate(base.rules[:weak]):
            if other.conclusions == rule.conclusions and other.connective == "and":
                is_above = (strengths[strong] >= strengths[weak] + 1e-3).all()
                assert weak in found or not is_above


# Contradictions and duplicates


def test_contradictory_rules() -> None:
    base = reference_base()
    swapped = Rule((Condition(1, 0), Condition(0, 0)), (4,))
    (finding,) = of_kind(with_rules(base, *base.rules, swapped), CONTRADICTORY)
    assert finding.place == "rule 17"
    assert "rule 1 and rule 17" in finding.text and "I IS Z and I IS VL" in finding.text
    negated = Rule((Condition(1, 0), Condition(0, 0, negated=True)), (4,))
    assert of_kind(with_rules(base, *base.rules, negated), CONTRADICTORY) == []


def test_or_does_not_contradict_and() -> None:
    base = reference_base()
    either = Rule(base.rules[0].conditions, (4,), "or")
    assert of_kind(with_rules(base, *base.rules, either), CONTRADICTORY) == []


def test_sets_of_equal_shape_contradict_whatever_their_names() -> None:
    sets = (triangle("one", 0, 5, 10), triangle("other", 0, 5, 10))
    base = one_input_base(sets, (Singleton("t", 1.0), Singleton("u", 2.0)), WEIGHTED_MAX)
    assert len(of_kind(base, CONTRADICTORY)) == 1


@pytest.mark.parametrize(
    ("method", "weight", "words"),
    [
        (WEIGHTED_MAX, 1.0, "no effect"),
        (WEIGHTED_SUM, 1.0, "counts twice"),
        (CENTROID, 0.5, "only the greater weight counts"),
    ],
)
def test_duplicates(method: str, weight: float, words: str) -> None:
    base = reference_base(method)
    repeated = with_rules(base, *base.rules, when(0, 0, 0, weight))
    (finding,) = of_kind(repeated, DUPLICATE)
    assert finding.place == "rule 17" and words in finding.text
    assert of_kind(repeated, UNREACHABLE) == of_kind(repeated, CONTRADICTORY) == []
    assert of_kind(base, DUPLICATE) == []


# Monotony


def test_a_spike_between_two_sets_turns_back() -> None:
    """From 5 on the output rises to 6 at x = 6, then x / (x - 5) falls to 3.5 at the spike."""
    sets = (triangle("low", 0, 0, 5), triangle("middle", 0, 5, 10), triangle("high", 5, 10, 10))
    terms = (Singleton("0", 0.0), Singleton("5", 5.0), Singleton("10", 10.0))
    assert reversals(one_input_base(sets, terms, WEIGHTED_MAX)) == []
    base = one_input_base((*sets, triangle("spike", 6, 7, 8)), terms, WEIGHTED_MAX)
    (found,) = reversals(with_rules(base, *base.rules[:3], Rule((Condition(0, 3),), (0,))))
    assert (found.gap.names, found.gap.start, found.gap.end) == (("middle", "spike"), 5, 7)
    assert (found.at, found.places, found.of_places) == ((6.0,), 1, 1)
    assert found.height == pytest.approx(1.0, abs=1e-12)


def test_reversal_has_its_height_and_place() -> None:
    """Two triangles that say the same: 1 at the cores, both 0.5 between, with a constant 0 rule.

    Weighted average of 10 with strength s and 0 with strength 1/2: 10 s / (s + 1/2); 20/3 at the
    cores, 5 in the middle.
    """
    sets = (triangle("a", 0, 0, 10), triangle("b", 0, 10, 10), FuzzySet("half", ((0.0, 0.5),)))
    terms = (Singleton("10", 10.0), Singleton("0", 0.0))
    base = one_input_base(sets, terms, WEIGHTED_MAX)
    rules = (*(Rule((Condition(0, i),), (0,)) for i in (0, 1)), Rule((Condition(0, 2),), (1,)))
    (finding,) = of_kind(with_rules(base, *rules), NON_MONOTONE)
    assert finding.severity == WARNING and finding.place == "x = 5"
    assert "by up to 1.67 (17 % of its range)" in finding.text
    wide = dataclasses.replace(base.outputs[0], minimum=-500.0, maximum=500.0)
    small = dataclasses.replace(with_rules(base, *rules), outputs=(wide,))
    assert [finding.severity for finding in of_kind(small, NON_MONOTONE)] == [NOTE]


def test_centroid_of_the_reference_turns_where_a_term_weakens() -> None:
    """At a = 15 both H and VH of f say VL, whose strength is 1, 0.5, 1 along f."""
    base = reference_base(CENTROID)
    places = [finding.place for finding in of_kind(base, NON_MONOTONE)]
    assert "f = 15.5, a = 15" in places
    ends = evaluate(base, [np.array([13.0, 15.5]), np.full(2, 15.0)]).outputs[0]
    assert f"by up to {ends[0] - ends[1]:.3g}" in of_kind(base, NON_MONOTONE)[0].text


def test_gaps_with_uncovered_places_are_not_called_turns() -> None:
    sets = (triangle("low", 0, 0, 4), triangle("high", 6, 10, 10))
    terms = (Singleton("0", 0.0), Singleton("10", 10.0))
    base = one_input_base(sets, terms, WEIGHTED_MAX, default=-5.0)
    kinds = {finding.kind for finding in analyse(base)}
    assert kinds == {UNCOVERED}


# All


def test_errors_come_first() -> None:
    base = dataclasses.replace(
        without_rule(reference_base(CENTROID), 0), outputs=reference_base(CENTROID, None).outputs
    )
    severities = [finding.severity for finding in analyse(base)]
    assert severities[0] == ERROR and WARNING in severities


@pytest.mark.parametrize("seed", range(30))
def test_findings_are_single_lines_with_a_place(seed: int) -> None:
    for finding in analyse(random_base(seed, METHODS[seed % 3])):
        assert finding.text and finding.place and "\n" not in finding.text
