"""The float64 meaning of a rule base: hand-computed, and against brute force."""

import itertools
from fractions import Fraction

import numpy as np
import pytest
from quiesce.rules.model import (
    AND,
    CENTROID,
    METHODS,
    WEIGHTED_MAX,
    WEIGHTED_SUM,
    Condition,
    FuzzySet,
    Rule,
    RuleBase,
    Singleton,
    trapezoid,
    triangle,
)
from quiesce.rules.reference import evaluate, membership
from rule_examples import one_input_base, random_base, reference_base

ALWAYS = FuzzySet("always", ((0.0, 1.0),))


def value(base: RuleBase, *inputs: float) -> float:
    return float(evaluate(base, [np.array([x]) for x in inputs]).outputs[0, 0])


# Memberships


@pytest.mark.parametrize("seed", range(40))
def test_membership_is_that_of_the_model(seed: int) -> None:
    base = random_base(seed, WEIGHTED_MAX)
    for variable in base.inputs:
        for one in variable.sets:
            edges = np.array([x for x, _ in one.points])
            x = np.concatenate([np.linspace(-3, 5, 201), edges, edges - 1e-9, edges + 1e-9])
            expected = [one.membership(float(at)) for at in x]
            assert membership(one, x) == pytest.approx(expected, abs=1e-12)


def test_greater_value_holds_at_a_vertical_edge() -> None:
    block = FuzzySet("block", ((2.0, 0.1), (2.0, 0.8), (5.0, 0.6), (5.0, 0.2)))
    x = np.array([1.0, np.nextafter(2.0, 0), 2.0, 5.0, np.nextafter(5.0, 9), 9.0])
    assert membership(block, x) == pytest.approx([0.1, 0.1, 0.8, 0.6, 0.2, 0.2])


def test_set_of_one_point_is_constant() -> None:
    assert membership(ALWAYS, np.array([-5.0, 0.0, 7.0])).tolist() == [1.0, 1.0, 1.0]


# Strengths


def test_strengths_of_connectives_negation_and_weight() -> None:
    base = reference_base()
    conditions = (Condition(0, 0), Condition(1, 1, negated=True))
    rules = (
        Rule(conditions, (0,)),
        Rule(conditions, (0,), "or", 0.5),
        Rule((Condition(1, 1),), (1,), weight=0.25),
    )
    base = RuleBase("strengths", base.inputs, base.outputs, rules)
    # f = 4: S 0.8; a = 3: M 0.25
    strengths = evaluate(base, [np.array([4.0]), np.array([3.0])], want_strengths=True).strengths
    assert strengths is not None
    assert strengths[:, 0] == pytest.approx([0.75, 0.4, 0.0625])


def test_strengths_are_left_out_unless_wanted() -> None:
    assert evaluate(reference_base(), [np.zeros(3), np.zeros(3)]).strengths is None


# Weighted average


def test_sum_counts_every_rule_and_max_every_term() -> None:
    # f = 5.5: S 0.5, M 0.5; a = 5: S 0.25, M 0.75. Rules: Z 0.25, S 0.5, S 0.25, M 0.5.
    assert value(reference_base(WEIGHTED_SUM), 5.5, 5.0) == pytest.approx(
        (0.75 * 1.25 + 0.5 * 2.5) / 1.5, abs=1e-15
    )
    assert value(reference_base(WEIGHTED_MAX), 5.5, 5.0) == pytest.approx(
        (0.5 * 1.25 + 0.5 * 2.5) / 1.25, abs=1e-15
    )


def test_sum_and_max_differ_by_what_peers_differ_by() -> None:
    """fuzzylite 6 and 7 are 0.335 A apart on this controller."""
    grid = [np.linspace(0, 25, 1000)[:, None], np.linspace(0, 20, 1000)[None, :]]
    sums, maxima = (evaluate(reference_base(m), grid) for m in (WEIGHTED_SUM, WEIGHTED_MAX))
    assert np.abs(sums.outputs - maxima.outputs).max() == pytest.approx(0.335, abs=5e-4)


def test_inputs_clamp_to_their_universe() -> None:
    for method in METHODS:
        base = reference_base(method)
        assert value(base, -7.0, 99.0) == value(base, 0.0, 20.0)


# Centroid


def test_centroid_of_one_triangle_is_its_own() -> None:
    base = one_input_base((ALWAYS,), (triangle("t", 1, 4, 9),), CENTROID)
    assert value(base, 3.0) == pytest.approx((1 + 4 + 9) / 3, rel=1e-15)


def test_centroid_of_a_clipped_triangle() -> None:
    half = FuzzySet("quarter", ((0.0, 0.25),))
    base = one_input_base((half,), (triangle("t", 0, 4, 8),), CENTROID)
    assert value(base, 3.0) == pytest.approx(4.0, rel=1e-15)
    lopsided = one_input_base((half,), (triangle("t", 0, 8, 8),), CENTROID)
    # Ramp 0..2 (area 1/4, centre 4/3), then 1/4 from 2 to 8 (area 3/2, centre 5).
    assert value(lopsided, 3.0) == pytest.approx((0.25 * 4 / 3 + 1.5 * 5) / 1.75, rel=1e-15)


def test_centroid_is_cut_at_the_universe() -> None:
    base = one_input_base((ALWAYS,), (triangle("t", -4, 0, 4),), CENTROID)
    assert value(base, 0.0) == pytest.approx(4.0 / 3.0, rel=1e-15)


def test_overlap_counts_once() -> None:
    """A set inside another one adds nothing."""
    outer, inner = trapezoid("outer", 1, 2, 5, 8), triangle("inner", 2, 3, 4)
    both = one_input_base((ALWAYS, ALWAYS), (outer, inner), CENTROID)
    alone = one_input_base((ALWAYS,), (outer,), CENTROID)
    assert value(both, 0.0) == pytest.approx(value(alone, 0.0), rel=1e-15)


def test_vertical_edges_of_an_output_set() -> None:
    """A block and half a block: areas 2 and 2, centres 1 and 6."""
    block = trapezoid("block", 0, 0, 2, 2)
    low = FuzzySet("low", ((4.0, 0.0), (4.0, 0.5), (8.0, 0.5), (8.0, 0.0)))
    base = one_input_base((ALWAYS, ALWAYS), (block, low), CENTROID)
    assert value(base, 0.0) == pytest.approx((2 * 1 + 2 * 6) / 4, rel=1e-15)


def test_centroid_of_a_weak_rule_is_as_exact_as_of_a_strong_one() -> None:
    """Strength 1e-9 makes a flat slab: its centre is the middle of the triangle's foot."""
    weak = FuzzySet("weak", ((0.0, 1e-9),))
    base = one_input_base((weak,), (triangle("t", 1, 2, 9),), CENTROID)
    slab = 5.0
    assert value(base, 0.0) == pytest.approx(slab, abs=3e-9)
    foot = 1e-9  # of the rising edge; the falling one is 7 times as long
    area = 8 - (1 + 7) * foot / 2
    moment = 0.5 * (81 - 1) - foot / 2 * (1 + foot / 3) - 7 * foot / 2 * (9 - 7 * foot / 3)
    assert value(base, 0.0) == pytest.approx(moment / area, abs=1e-13)


def brute_force(base: RuleBase, strengths: np.ndarray, samples: int) -> np.ndarray:
    """Centroids of the aggregated set by the midpoint rule; strengths [rule, point]."""
    output = base.outputs[0]
    width = (output.maximum - output.minimum) / samples
    y = output.minimum + width * (np.arange(samples) + 0.5)
    aggregated = np.zeros((strengths.shape[1], samples))
    for rule, strength in zip(base.rules, strengths, strict=True):
        mu = membership(output.terms[rule.conclusions[0]], y)
        np.maximum(aggregated, np.minimum(strength[:, None], mu), out=aggregated)
    with np.errstate(invalid="ignore"):
        return aggregated @ y / aggregated.sum(axis=1)


@pytest.mark.parametrize("seed", range(60))
def test_centroid_agrees_with_brute_force(seed: int) -> None:
    base = random_base(seed, CENTROID)
    random = np.random.default_rng(seed)
    points = [random.uniform(-1.5, 3.5, 40) for _ in base.inputs]
    answer = evaluate(base, points, want_strengths=True)
    assert answer.strengths is not None
    found = ~answer.is_default[0]
    errors = []
    for samples in (2000, 20000):
        expected = brute_force(base, answer.strengths[:, found], samples)
        area_is_seen = np.isfinite(expected)
        errors.append(np.abs(answer.outputs[0, found] - expected)[area_is_seen].max(initial=0.0))
    # Vertical edges cost the midpoint rule up to a step of its grid each.
    assert errors[0] < 0.05 and errors[1] < 5e-3


def exact_membership(points: tuple, x: Fraction) -> Fraction:
    """Between breakpoints, in rational numbers."""
    fractions = [(Fraction(at), Fraction(mu)) for at, mu in points]
    after = next((i for i, (at, _) in enumerate(fractions) if at > x), len(fractions))
    if after in (0, len(fractions)):
        return fractions[min(after, len(fractions) - 1)][1]
    (x0, mu0), (x1, mu1) = fractions[after - 1 : after + 1]
    return mu0 + (mu1 - mu0) * (x - x0) / (x1 - x0)


def exact_centroid(base: RuleBase, strengths: np.ndarray) -> Fraction:
    """In rational numbers, from strengths [rule]: pieces end wherever two lines or levels meet."""
    output = base.outputs[0]
    sets = [output.terms[rule.conclusions[0]].points for rule in base.rules]
    levels = [Fraction(float(strength)) for strength in strengths]
    low, high = Fraction(output.minimum), Fraction(output.maximum)
    places = {low, high} | {Fraction(x) for points in sets for x, _ in points}
    edges = sorted(x for x in places if low <= x <= high)
    area = moment = Fraction(0)
    for start, end in itertools.pairwise(edges):
        third = (end - start) / 3
        lines = [(level, Fraction(0)) for level in levels]  # value at start, slope
        for points in sets:
            mu = [exact_membership(points, start + k * third) for k in (1, 2)]
            lines.append((2 * mu[0] - mu[1], (mu[1] - mu[0]) / third))
        meets = {
            start + (d - b) / (m - n)
            for (b, m), (d, n) in itertools.combinations(lines, 2)
            if m != n
        }
        cuts = sorted({start, end} | {x for x in meets if start < x < end})
        for left, right in itertools.pairwise(cuts):
            values = [
                max(min(s, exact_membership(p, x)) for s, p in zip(levels, sets, strict=True))
                for x in (left + (right - left) / 4, right - (right - left) / 4)
            ]
            middle, slope = sum(values) / 2, (values[1] - values[0]) / ((right - left) / 2)
            area += (right - left) * middle
            moment += (right - left) * middle * (left + right) / 2 + slope * (
                right - left
            ) ** 3 / 12
    return moment / area


@pytest.mark.parametrize("seed", range(60))
def test_centroid_is_exact(seed: int) -> None:
    base = random_base(seed, CENTROID)
    random = np.random.default_rng(seed)
    points = [random.uniform(-1.5, 3.5, 5) for _ in base.inputs]
    answer = evaluate(base, points, want_strengths=True)
    assert answer.strengths is not None
    for i in np.flatnonzero(~answer.is_default[0]):
        exact = exact_centroid(base, answer.strengths[:, i])
        assert abs(Fraction(float(answer.outputs[0, i])) - exact) < Fraction(1, 10**13)


def test_centroid_of_the_reference_controller_is_what_sampling_converges_to() -> None:
    base = reference_base(CENTROID)
    random = np.random.default_rng(3)
    points = [random.uniform(0, 25, 300), random.uniform(0, 20, 300)]
    answer = evaluate(base, points, want_strengths=True)
    assert answer.strengths is not None
    errors = [
        np.abs(answer.outputs[0] - brute_force(base, answer.strengths, samples)).max()
        for samples in (200, 2000, 20000)
    ]
    assert errors[0] < 3e-4 and errors[1] < 3e-6 and errors[2] < 3e-8


# Defaults


@pytest.mark.parametrize("method", METHODS)
def test_default_where_nothing_fires(method: str) -> None:
    terms = (triangle("t", 2, 4, 6),) if method == CENTROID else (Singleton("t", 4.0),)
    sets = (triangle("s", 2, 4, 6),)
    base = one_input_base(sets, terms, method, default=7.5)
    answer = evaluate(base, [np.array([2.0, 2.5, 6.0, 9.0])])
    assert answer.outputs[0] == pytest.approx([7.5, 4.0, 7.5, 7.5])
    assert answer.is_default[0].tolist() == [True, False, True, True]
    silent = one_input_base(sets, terms, method, default=None)
    assert np.isnan(evaluate(silent, [np.array([9.0])]).outputs[0, 0])


def test_default_where_what_fires_has_no_area() -> None:
    """A set beyond the output's universe has no centroid in it."""
    base = one_input_base((ALWAYS,), (triangle("t", 12, 14, 16),), CENTROID, default=7.5)
    answer = evaluate(base, [np.array([3.0])])
    assert answer.outputs[0, 0] == 7.5 and answer.is_default[0, 0]


def test_outputs_are_independent() -> None:
    """A rule that says nothing about an output does not make it fire."""
    base = one_input_base((ALWAYS,), (Singleton("t", 4.0),), WEIGHTED_MAX, default=1.0)
    two = RuleBase(
        "two", base.inputs, base.outputs * 2, (Rule((Condition(0, 0),), (None, 0), AND),)
    )
    answer = evaluate(two, [np.array([3.0])])
    assert answer.outputs[:, 0].tolist() == [1.0, 4.0]
    assert answer.is_default[:, 0].tolist() == [True, False]


# Shapes


@pytest.mark.parametrize("method", METHODS)
def test_open_axes_give_the_grid(method: str) -> None:
    base = random_base(5, method, input_count=3)
    x, y, z = np.linspace(-1, 3, 300), np.linspace(-1, 3, 31), np.linspace(-1, 3, 7)
    grid = evaluate(base, [x[:, None, None], y[:, None], z], want_strengths=True)
    points = [axis.ravel() for axis in np.meshgrid(x, y, z, indexing="ij")]
    flat = evaluate(base, points, want_strengths=True)
    assert grid.outputs.shape == (1, 300, 31, 7)
    assert np.array_equal(grid.outputs.ravel(), flat.outputs.ravel())
    assert grid.strengths is not None and flat.strengths is not None
    assert np.array_equal(grid.strengths.ravel(), flat.strengths.ravel())
