"""Rule bases as genomes: what decodes is valid, what encodes comes back."""

from dataclasses import replace

import numpy as np
import pytest
from quiesce.base.errors import UsageError
from quiesce.rules.model import (
    WEIGHTED_SUM,
    Condition,
    FuzzySet,
    Input,
    Output,
    Rule,
    RuleBase,
    Singleton,
    triangle,
)
from quiesce.rules.optimize.genes import GAP_SHARE, breakpoints, make_space
from quiesce.rules.optimize.start import chain

ALL = ("rules", "sets", "outputs")


def trapezoid_input() -> Input:
    """Flat tops, and outer points beyond the shoulders' plateaus."""
    sets = (
        FuzzySet("low", ((0.0, 1.0), (1.0, 1.0), (2.0, 0.0))),
        FuzzySet("mid", ((1.0, 0.0), (2.0, 1.0), (5.0, 1.0), (7.0, 0.0))),
        FuzzySet("high", ((5.0, 0.0), (7.0, 1.0), (10.0, 1.0))),
    )
    return Input("a", 0.0, 10.0, sets)


def some_base() -> RuleBase:
    first = Input("f", 0.0, 25.0, chain(("S", "M", "H", "VH"), (5.0, 10.0, 15.0, 20.0)))
    terms = tuple(Singleton(name, value) for name, value in (("Z", 0.0), ("L", 5.0), ("M", 2.0)))
    rules = tuple(
        Rule((Condition(0, i), Condition(1, j)), ((i + j) % 3,)) for i in range(4) for j in range(3)
    )
    output = Output("I", 0.0, 5.0, terms, WEIGHTED_SUM, default=0.0)
    return RuleBase("some", (first, trapezoid_input()), (output,), rules)


def random_genome(space, rng: np.random.Generator) -> tuple[int, ...]:
    return tuple(int(rng.integers(count)) for count in space.levels)


def sums(variable: Input) -> list[float]:
    xs = np.linspace(variable.minimum, variable.maximum, 401)
    return [sum(one.membership(x) for one in variable.sets) for x in xs]


def test_genome_has_a_gene_for_every_tuned_place() -> None:
    base = some_base()
    assert make_space(base, ["rules"]).levels == (3,) * 12
    assert make_space(base, ["sets"]).levels == (1024,) * (4 + 4)
    assert make_space(base, ["outputs"]).levels == (1024,) * 3
    assert len(make_space(base, ALL).levels) == 12 + 8 + 3


def test_start_comes_back_from_its_genome_within_half_a_code() -> None:
    base = some_base()
    space = make_space(base, ALL)
    again = space.decode(space.encode(base))
    assert again.rules == base.rules
    for variable, before in zip(again.inputs, base.inputs, strict=True):
        code = (before.maximum - before.minimum) / 1023
        assert np.allclose(breakpoints(variable), breakpoints(before), atol=0.5 * code)
    values = [term.value for term in again.outputs[0].terms]
    assert np.allclose(values, [0.0, 5.0, 2.0], atol=0.5 * 5.0 / 1023)


def test_rules_alone_leave_all_else_exactly_as_it_was() -> None:
    base = some_base()
    space = make_space(base, ["rules"])
    assert space.decode(space.encode(base)) == base
    genome = random_genome(space, np.random.default_rng(1))
    changed = space.decode(genome)
    assert changed.inputs == base.inputs and changed.outputs == base.outputs
    assert tuple(rule.conclusions[0] for rule in changed.rules) == genome


def test_any_genome_is_a_valid_base_and_survives_the_round_trip() -> None:
    base = some_base()
    space = make_space(base, ALL)
    rng = np.random.default_rng(2)
    for _ in range(60):
        genome = random_genome(space, rng)
        found = space.decode(genome)
        assert space.encode(found) == space.canonical(genome)
        assert space.decode(space.canonical(genome)) == found
        for variable in found.inputs:
            points = breakpoints(variable)
            gap = GAP_SHARE * (variable.maximum - variable.minimum)
            assert min(np.diff(points)) >= 0.999 * gap
            assert points[0] >= variable.minimum and points[-1] <= variable.maximum
            assert np.allclose(sums(variable), 1.0)


def test_genomes_of_one_meaning_have_one_canonical_form() -> None:
    space = make_space(some_base(), ["sets"])
    one = (5, 900, 300, 600, 1, 2, 3, 4)
    other = (300, 600, 5, 900, 4, 3, 2, 1)
    assert space.decode(one) == space.decode(other)
    assert space.canonical(one) == space.canonical(other) == (5, 300, 600, 900, 1, 2, 3, 4)


def test_singletons_keep_the_order_of_their_names() -> None:
    space = make_space(some_base(), ["outputs"])
    found = space.decode((1023, 0, 512))
    values = {term.name: term.value for term in found.outputs[0].terms}
    assert values["Z"] == 0.0 and values["L"] == 5.0
    assert values["Z"] < values["M"] < values["L"]


def test_flat_tops_stay_flat() -> None:
    space = make_space(some_base(), ["sets"])
    found = space.decode((0, 300, 600, 1023, 100, 300, 500, 900))
    kinds = [len([mu for _, mu in one.points if mu == 1.0]) for one in found.inputs[1].sets]
    assert kinds == [1, 2, 1]


def test_sets_that_do_not_add_up_to_one_cannot_move() -> None:
    base = some_base()
    gap = Input("g", 0.0, 10.0, (triangle("L", 0, 1, 2), triangle("H", 6, 8, 10)))
    wide = Input("w", 0.0, 10.0, (*chain(("L", "H"), (2.0, 8.0)), triangle("M", 2, 5, 8)))
    for variable in (gap, wide):
        broken = replace(base, inputs=(base.inputs[0], variable))
        with pytest.raises(UsageError, match=f"sets of {variable.name} do not add up to 1"):
            make_space(broken, ["sets"])
        make_space(broken, ["rules"])


def test_outputs_with_sets_cannot_be_tuned() -> None:
    base = some_base()
    output = replace(base.outputs[0], terms=(triangle("L", 0, 1, 2),))
    with pytest.raises(UsageError, match="terms of I are sets"):
        make_space(replace(base, outputs=(output,)), ["outputs"])


def test_a_base_without_genes_is_refused() -> None:
    base = some_base()
    single = tuple(replace(v, sets=v.sets[:1]) for v in base.inputs)
    with pytest.raises(UsageError, match="nothing to tune"):
        make_space(replace(base, inputs=single), ["sets"])
