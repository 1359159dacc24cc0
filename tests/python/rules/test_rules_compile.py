"""From rule bases to integers and C: what both engines compute, against exact arithmetic and the
float64 reference; what is refused; C that compilers accept."""

import itertools
import shutil
import subprocess
from dataclasses import replace
from fractions import Fraction
from math import ceil
from pathlib import Path

import numpy as np
import pytest
from conftest import ROOT
from quiesce.base.errors import UsageError
from quiesce.rules.engine.engine import STRAIGHT, TABLE, Engine
from quiesce.rules.integers.c_files import header_c, source_c
from quiesce.rules.integers.cells import Cell, exact_membership
from quiesce.rules.integers.compile import compile_base
from quiesce.rules.integers.compiled import CompiledBase
from quiesce.rules.integers.emit import NotStraight, straight_line_c, why_not_straight
from quiesce.rules.integers.table import table_words
from quiesce.rules.model import (
    CENTROID,
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
from quiesce.rules.proof.explained import explained_errors
from quiesce.rules.reference import evaluate
from quiesce_benchmarks.fuzzy.random import random_base
from quiesce_benchmarks.fuzzy.reference import MAX, SUM, VARIANTS, Variant, compiled, reference_base
from quiesce_benchmarks.fuzzy.reference import METHODS as REFERENCE_METHODS

INT32_MIN, INT32_MAX = -(2**31), 2**31 - 1
SEED = 20260
RANDOM_BASES = 64
WEAKEST = 2.0**-20  # of a point's strongest rule: less may round to nothing


# Memberships in integers


def integers_in(cell: Cell, count: int, rng: np.random.Generator) -> list[int]:
    """Ends, middle and some between."""
    middle = (cell.first + cell.last) // 2
    spread = rng.integers(cell.first, cell.last, count, endpoint=True)
    return [cell.first, cell.last, middle, *map(int, spread)]


def exact_at(base: CompiledBase, index: int, n: int) -> dict[int, Fraction]:
    """Memberships of the sets from left to right, the input clamped to its universe."""
    variable, axis = base.base.inputs[index], base.axes[index]
    low, high = (axis.position(end) for end in (variable.minimum, variable.maximum))
    x = axis.origin + min(max(Fraction(n), low), high) * axis.lsb
    order = base.set_order[index]
    found = {place: exact_membership(variable.sets[k], x) for place, k in enumerate(order)}
    return {place: mu for place, mu in found.items() if mu}


def random_compiled(number: int) -> CompiledBase:
    """A random base, every second one in units of its own."""
    base = random_base(SEED, number).base
    if number % 2 == 0:
        return compile_base(base)
    inputs = [(one.maximum - one.minimum) / 1e6 for one in base.inputs]
    return compile_base(base, inputs, [(one.maximum - one.minimum) / 1e4 for one in base.outputs])


@pytest.mark.parametrize("number", range(20))
def test_cells_cover_all_integers_and_memberships_are_to_nearest(number: int) -> None:
    base = random_compiled(number)
    rng = np.random.default_rng(number)
    one = 1 << base.bits
    for index, cells in enumerate(base.cells):
        assert cells[0].first == INT32_MIN and cells[-1].last == INT32_MAX
        assert all(a.last + 1 == b.first for a, b in itertools.pairwise(cells))
        for cell in cells:
            for n in integers_in(cell, 8, rng):
                found, wanted = cell.memberships(n), exact_at(base, index, n)
                for place in found.keys() | wanted.keys():
                    integer = found.get(place, 0)
                    assert 0 <= integer <= one
                    assert abs(integer - wanted.get(place, 0) * one) <= Fraction(3, 4), (index, n)


@pytest.mark.parametrize("variant", VARIANTS, ids=lambda one: one.name)
def test_complementary_pairs_add_up_to_one_exactly(variant: Variant) -> None:
    base = compiled(variant)
    rng = np.random.default_rng(3)
    assert base.is_partition
    for cell in itertools.chain(*base.cells):
        for n in integers_in(cell, 200, rng):
            assert sum(cell.memberships(n).values()) == 1 << base.bits


def test_membership_at_a_vertical_edge_is_the_greater_one() -> None:
    sets = (trapezoid("block", 2, 2, 5, 5), FuzzySet("rest", ((0.0, 0.25),)))
    base = RuleBase(
        "edges",
        (Input("x", 0.0, 10.0, sets),),
        (Output("y", 0.0, 1.0, (Singleton("a", 0.0), Singleton("b", 1.0)), WEIGHTED_SUM, 0.5),),
        (Rule((Condition(0, 0),), (1,)), Rule((Condition(0, 1),), (0,))),
    )
    built = compile_base(base, [0.5], [1e-4])
    out, _ = Engine(built).evaluate([np.array([3, 4, 5, 9, 10, 11], dtype=np.int32)])
    assert out[0].tolist() == [0, 8000, 8000, 8000, 8000, 0]


# Engines


def cell_corners(base: CompiledBase, rng: np.random.Generator, count: int) -> list[np.ndarray]:
    """Random integers inside the universes, ends of cells, and far outside."""
    points = []
    for index, cells in enumerate(base.cells):
        variable = base.base.inputs[index]
        inside = base.input_integer(index, rng.uniform(variable.minimum, variable.maximum, count))
        ends = np.array([end for cell in cells for end in (cell.first, cell.last)], np.int32)
        points.append(np.concatenate([inside, rng.choice(ends, count)]))
    return [rng.permutation(values) for values in points]


def assert_engines_agree(base: CompiledBase, points: list[np.ndarray]) -> None:
    out, default = Engine(base, TABLE).evaluate(points)
    if not why_not_straight(base):
        straight, flags = Engine(base, STRAIGHT).evaluate(points)
        np.testing.assert_array_equal(out, straight)
        np.testing.assert_array_equal(default, flags)


def exact_values(base: CompiledBase, points: list[np.ndarray]) -> list[np.ndarray]:
    """The float nearest to what an integer stands for: at an edge it is the edge."""
    return [
        np.array([float(axis.origin + int(n) * axis.lsb) for n in values])
        for axis, values in zip(base.axes, points, strict=True)
    ]


def assert_near_the_reference(base: CompiledBase, points: list[np.ndarray]) -> None:
    reference = evaluate(base.base, exact_values(base, points), want_strengths=True)
    assert reference.strengths is not None
    allowed = explained_errors(base, reference)
    out, default = Engine(base, TABLE).evaluate(points)
    for index, rows in enumerate(out):
        concluding = [i for i, r in enumerate(base.base.rules) if r.conclusions[index] is not None]
        strongest = reference.strengths[concluding].max(axis=0, initial=0.0)
        is_clear = (strongest == 0) | (strongest >= WEAKEST)
        is_default = (default >> index & 1).astype(bool)
        np.testing.assert_array_equal(is_default[is_clear], reference.is_default[index][is_clear])
        wanted = reference.outputs[index]
        counts = np.abs(base.output_value(index, rows) - wanted) / base.output_lsb(index)
        limit = np.where(is_default, 0.5 + 1e-6, allowed[index] + 1e-6)
        beyond = is_clear & ~(counts <= limit)
        assert not beyond.any(), (index, counts[beyond].max(), limit[beyond].max())


@pytest.mark.parametrize("variant", VARIANTS, ids=lambda one: one.name)
def test_reference_controller_in_both_engines(variant: Variant) -> None:
    base = compiled(variant)
    points = cell_corners(base, np.random.default_rng(1), 20_000)
    assert not why_not_straight(base)
    assert_engines_agree(base, points)
    assert_near_the_reference(base, points)


@pytest.mark.parametrize(
    "number",
    [*range(12), *(pytest.param(k, marks=pytest.mark.slow) for k in range(12, RANDOM_BASES))],
)
def test_random_base_in_both_engines(number: int) -> None:
    base = random_compiled(number)
    points = cell_corners(base, np.random.default_rng(number), 1500)
    assert_engines_agree(base, points)
    assert_near_the_reference(base, points)


@pytest.mark.slow
def test_random_bases_are_of_all_kinds() -> None:
    bases = [random_compiled(number) for number in range(RANDOM_BASES)]
    straight = [not why_not_straight(base) for base in bases]
    assert {len(base.base.inputs) for base in bases} == {2, 3}
    assert {output.method for base in bases for output in base.outputs} == {
        WEIGHTED_SUM,
        WEIGHTED_MAX,
        CENTROID,
    }
    assert 0.3 * RANDOM_BASES <= sum(straight) < RANDOM_BASES
    assert sum(base.is_partition for base in bases) >= 8


def test_fired_rules_are_those_of_the_reference() -> None:
    base = compile_base(random_base(SEED, 6).base)
    points = cell_corners(base, np.random.default_rng(9), 500)
    strengths = evaluate(base.base, exact_values(base, points), want_strengths=True).strengths
    assert strengths is not None
    fired = Engine(base).fired(points)
    for index, row in enumerate(strengths[:64]):
        is_clear = (row == 0) | (row >= WEAKEST)
        np.testing.assert_array_equal((fired >> np.uint64(index) & np.uint64(1))[is_clear],
                                      (row > 0)[is_clear])  # fmt: skip


# What the compiler refuses


def ramps(count: int) -> tuple[FuzzySet, ...]:
    return tuple(triangle(f"s{k}", k - 1, k, k + 1) for k in range(count))


def singleton_base(values: tuple[float, ...], low: float, high: float) -> RuleBase:
    terms = tuple(Singleton(f"t{k}", value) for k, value in enumerate(values))
    output = Output("y", low, high, terms, WEIGHTED_SUM, low)
    rules = tuple(Rule((Condition(0, k),), (k % len(values),)) for k in range(3))
    return RuleBase("base", (Input("x", 0.0, 2.0, ramps(3)),), (output,), rules)


def message_of(base: RuleBase, inputs="q15", outputs="q16") -> str:
    with pytest.raises(UsageError) as caught:
        _ = table_words(compile_base(base, inputs, outputs))
    text = str(caught.value)
    assert "\n" not in text and text
    return text


@pytest.mark.parametrize("lsb", [0, -1e-6, float("nan"), float("inf"), "0", "-2"])
def test_lsb_is_a_positive_number(lsb) -> None:
    base = singleton_base((0.0, 1.0), 0.0, 1.0)
    assert "a number above 0, please" in message_of(base, inputs=[lsb])
    assert "a number above 0, please" in message_of(base, outputs=[lsb])


def test_one_format_for_each_variable() -> None:
    base = reference_base(SUM)
    assert "1 formats for 2 variables" in message_of(base, inputs=["q15"])
    assert "2 formats for 1 variables" in message_of(base, outputs=["q16", "q16"])


def test_universe_of_an_input_fits_int32_and_holds_counts() -> None:
    base = singleton_base((0.0, 1.0), 0.0, 1.0)
    assert "input x: its universe does not fit int32" in message_of(base, inputs=[1e-10])
    assert "input x: its universe holds no two counts of 3" in message_of(base, inputs=[3])
    assert table_words(compile_base(base, [2.0 / INT32_MAX]))


def test_universe_of_an_output_has_2_to_the_24_counts_at_most() -> None:
    base = singleton_base((0.0, 1.0), 0.0, 1.0)
    assert "output y: more than 2^24 counts of 1e-08" in message_of(base, outputs=[1e-8])
    wide = singleton_base((0.0, 20.0), 0.0, 1.0)  # a singleton beyond its universe
    assert "output y: its singletons span more than 2^24 counts" in message_of(wide, outputs=[1e-6])
    far = singleton_base((3e9, 3e9 + 1), 3e9, 3e9 + 1)
    assert "output y" in message_of(far, outputs=[1.0])


def test_default_fits_int32() -> None:
    base = singleton_base((0.0, 1.0), 0.0, 1.0)
    output = replace(base.outputs[0], default=1e4)
    far = replace(base, outputs=(output,))
    assert "its default does not fit int32" in message_of(far, outputs=[1e-6])


def test_missing_default_is_chosen_and_told() -> None:
    base = singleton_base((2.0, 3.0), 2.0, 3.0)
    base = replace(base, outputs=(replace(base.outputs[0], default=None),))
    built = compile_base(base, outputs=[0.001])
    assert built.outputs[0].default == 2000
    assert built.notes == ("output y has no default: 2 where no rule fires",)
    built = compile_base(base, outputs=[0.001], defaults={"y": 2.5})
    assert built.outputs[0].default == 2500 and not built.notes


def centroid_base(*sets: FuzzySet) -> RuleBase:
    output = Output("y", 0.0, 10.0, sets, CENTROID, 0.0)
    rules = tuple(Rule((Condition(0, k % 3),), (k,)) for k in range(len(sets)))
    return RuleBase("centroid", (Input("x", 0.0, 2.0, ramps(3)),), (output,), rules)


@pytest.mark.parametrize(
    "poor",
    [
        triangle("poor", 5, 5.001, 5.002),
        FuzzySet("poor", ((0.0, 0.0), (10.0, 0.0))),
        triangle("poor", 11, 12, 13),
        trapezoid("poor", 10, 10, 10, 10),
    ],
    ids=["narrow", "zero", "outside", "spike"],
)
def test_output_set_without_area_is_refused(poor: FuzzySet) -> None:
    assert "output set y.poor" in message_of(centroid_base(triangle("a", 0, 3, 6), poor))


@pytest.mark.parametrize(
    "inner",
    [
        triangle("inner", 4, 5, 6),
        FuzzySet("inner", ((0.0, 0.0), (2.0, 1.0), (4.0, 0.3), (7.0, 1.0), (9.0, 0.0))),
        trapezoid("inner", 4.99, 5, 5.2, 9),
    ],
    ids=["nested", "dip", "steep"],
)
def test_output_sets_in_any_arrangement_are_exact(inner: FuzzySet) -> None:
    base = compile_base(centroid_base(triangle("a", 0, 3, 10), inner, triangle("c", 3, 9, 10)))
    points = [np.arange(-100, 33000, 7, dtype=np.int32)]
    assert_engines_agree(base, points)
    assert_near_the_reference(base, points)


# Limits: as much as the model allows compiles, and the firmware accepts it


def with_rules(count: int) -> RuleBase:
    """Rules of one input with 7 sets, again and again, weaker and weaker."""
    terms = tuple(Singleton(f"t{k}", float(k)) for k in range(64))
    output = Output("y", 0.0, 63.0, terms, WEIGHTED_SUM, 0.0)
    rules = tuple(
        Rule((Condition(0, k % 7),), (k % 64,), weight=1 / (1 + k // 7)) for k in range(count)
    )
    return RuleBase("many", (Input("x", 0.0, 6.0, ramps(7)),), (output,), rules)


@pytest.mark.parametrize("count", [15, 16, 255, 256, 257, 512, 1023, 1024])
def test_any_number_of_rules_up_to_the_limit(count: int) -> None:
    base = compile_base(with_rules(count), outputs=[0.001])
    points = [np.arange(-500, 33500, 61, dtype=np.int32)]
    assert_near_the_reference(base, points)


@pytest.mark.parametrize("lsb", [1.0, 2.0**-22, 2.0**-23, 5e-7, 1e-7])
@pytest.mark.parametrize("method", [SUM, MAX])
def test_outputs_of_any_number_of_counts(lsb: float, method: str) -> None:
    base = reference_base(method)
    if 5 / lsb > 2**24 - 2:
        assert "2^24" in message_of(base, outputs=[lsb])
        return
    built = compile_base(base, outputs=[lsb])
    points = cell_corners(built, np.random.default_rng(2), 2000)
    assert_engines_agree(built, points)
    assert_near_the_reference(built, points)


@pytest.mark.slow
@pytest.mark.parametrize("span", [2**22 - 1, 2**22, 2**24 - 2, 2**24 - 1, 2**24 - 0.4, 2**24])
@pytest.mark.parametrize("origin", [0, -(2**31) + 1, 2**31 - 1])
def test_singletons_at_the_ends_of_their_range(span: float, origin: int) -> None:
    """What is compiled the firmware accepts; the rest is refused with a reason."""
    low = float(origin if origin <= 0 else origin - ceil(span))
    base = singleton_base((low, low + span), low, low + 1.0)
    base = replace(base, outputs=(replace(base.outputs[0], default=low),))
    try:
        built = compile_base(base, outputs=[1.0])
    except UsageError as error:
        assert "output y" in str(error)
        return
    points = [np.arange(0, 32769, 64, dtype=np.int32)]
    assert_engines_agree(built, points)
    assert_near_the_reference(built, points)


def saw(teeth: int) -> FuzzySet:
    return FuzzySet("saw", tuple((k / teeth, float(k % 2)) for k in range(teeth + 1)))


@pytest.mark.slow
@pytest.mark.parametrize("teeth", [100, 200, 252, 253, 254, 255, 256, 400])
def test_number_of_cells_of_an_input(teeth: int) -> None:
    """255 cells: as many as a table counts."""
    terms = (Singleton("a", 0.0), Singleton("b", 1.0))
    output = Output("y", 0.0, 1.0, terms, WEIGHTED_SUM, 0.5)
    sets = (saw(teeth), FuzzySet("flat", ((0.0, 0.5),)))
    rules = (Rule((Condition(0, 0),), (1,)), Rule((Condition(0, 1),), (0,)))
    base = RuleBase("saw", (Input("x", 0.0, 1.0, sets),), (output,), rules)
    built = compile_base(base)
    if len(built.cells[0]) > 255:
        assert "input x" in message_of(base)
        return
    assert_near_the_reference(built, [np.arange(-9, 32800, 5, dtype=np.int32)])


# Straight-line C


def test_too_many_overlapping_sets_have_no_straight_line_form() -> None:
    wide = tuple(triangle(f"s{k}", k - 3, k, k + 3) for k in range(3))
    base = singleton_base((0.0, 1.0), 0.0, 1.0)
    base = replace(base, inputs=(replace(base.inputs[0], sets=wide),))
    built = compile_base(base)
    assert why_not_straight(built) == "3 sets of input x overlap; straight-line C takes 2"
    with pytest.raises(NotStraight, match="3 sets of input x overlap"):
        straight_line_c(built, "f")
    with pytest.raises(NotStraight):
        Engine(built, STRAIGHT)
    assert_near_the_reference(built, [np.arange(-9, 32800, 5, dtype=np.int32)])


def test_too_many_combinations_of_cells_have_no_straight_line_form() -> None:
    inputs = tuple(Input(f"x{k}", 0.0, 6.0, ramps(7)) for k in range(3))
    base = singleton_base((0.0, 1.0), 0.0, 1.0)
    built = compile_base(replace(base, inputs=inputs))
    assert why_not_straight(built) == "512 combinations of cells; straight-line C takes 400"


# C


WARNINGS = "all extra pedantic conversion sign-conversion shadow cast-align error"
GCC = ("gcc", "-std=c11", "-Wmissing-prototypes", *(f"-W{name}" for name in WARNINGS.split()))
COMPILERS = {"gcc": GCC, "clang": ("clang-14", *GCC[1:])}


def compile_c(folder: Path, compiler: str, base: CompiledBase, name: str) -> None:
    if shutil.which(COMPILERS[compiler][0]) is None:
        pytest.fail(f"{COMPILERS[compiler][0]} is missing: run ./tools/setup test", pytrace=False)
    (folder / f"{name}.h").write_text(header_c(base, name, "// banner\n"))
    (folder / f"{name}.c").write_text(source_c(base, name, "// banner\n"))
    includes = [f"-I{ROOT}/firmware/{part}" for part in ("base", "fuzzy")]
    result = subprocess.run(
        [*COMPILERS[compiler], *includes, "-O2", "-c", f"{name}.c", "-o", "out.o"],
        cwd=folder,
        capture_output=True,
        text=True,
    )
    assert result.returncode == 0, result.stderr[:2000]


@pytest.mark.slow
@pytest.mark.parametrize("compiler", COMPILERS)
def test_c_compiles_without_a_warning(compiler: str, tmp_path: Path) -> None:
    bases = [compile_base(reference_base(method)) for method in REFERENCE_METHODS]
    bases += [random_compiled(number) for number in range(14)]
    for number, base in enumerate(bases):
        compile_c(tmp_path, compiler, base, f"rules_{number}")


def test_c_of_a_base_with_extreme_integers_compiles(tmp_path: Path) -> None:
    low = float(INT32_MIN + 1)
    base = singleton_base((low, low + 9), low, low + 10)
    for compiler in COMPILERS:
        compile_c(tmp_path, compiler, compile_base(base, [1e-9], [1.0]), "extreme")


def test_c_is_a_function_of_the_base() -> None:
    one, other = (compile_base(reference_base(MAX)) for _ in range(2))
    assert source_c(one, "a", "") == source_c(other, "a", "")
    assert "a_table[" in header_c(one, "a", "") and "uint32_t a(" in header_c(one, "a", "")


def one_input_base(weights: tuple[float, float]) -> RuleBase:
    falling = FuzzySet("a", ((0.0, 1.0), (1.0, 0.0)))
    rising = FuzzySet("b", ((0.0, 0.0), (1.0, 1.0)))
    output = Output("y", 0, 5, (Singleton("l", 0.3), Singleton("h", 4.9)), WEIGHTED_SUM, 0.0)
    rules = tuple(
        Rule((Condition(0, index),), (index,), weight=weight)
        for index, weight in enumerate(weights)
    )
    return RuleBase("weights", (Input("x", 0, 1, (falling, rising)),), (output,), rules)


@pytest.mark.parametrize(
    "weights", [(0.05, 0.03), (1e-3, 3e-4), (1e-5, 1.3e-5), (1, 1e-5), (9e-7, 1)]
)
def test_small_weights_keep_their_ratio(weights: tuple[float, float]) -> None:
    base = one_input_base(weights)
    compiled = compile_base(base)
    points = np.arange(32769, dtype=np.int32)
    answers = [Engine(compiled, kind).evaluate([points])[0] for kind in (TABLE, STRAIGHT)]
    exact = evaluate(base, [compiled.input_value(0, points)]).outputs[0]
    assert np.array_equal(*answers)
    error = np.abs(compiled.output_value(0, answers[0][0]) - exact)
    assert error.max() < 0.7 * compiled.output_lsb(0)


def test_a_weight_too_small_for_the_integers_is_refused() -> None:
    with pytest.raises(UsageError, match="too small"):
        compile_base(one_input_base((1.0, 1e-13)))


def test_an_input_that_no_rule_asks_for_compiles_without_warnings() -> None:
    base = one_input_base((1.0, 1.0))
    unused = Input("idle", 0, 1, base.inputs[0].sets)
    compiled = compile_base(replace(base, inputs=(*base.inputs, unused)))
    points = np.arange(0, 32769, 77, dtype=np.int32)
    answers = [
        Engine(compiled, kind).evaluate([points, points[::-1]])[0] for kind in (TABLE, STRAIGHT)
    ]
    assert np.array_equal(*answers)


def test_a_universe_of_nearly_all_int32_compiles() -> None:
    base = one_input_base((1.0, 1.0))
    wide = Input("x", -2000.0, 2000.0, (
        FuzzySet("a", ((-2000.0, 1.0), (2000.0, 0.0))),
        FuzzySet("b", ((-2000.0, 0.0), (2000.0, 1.0))),
    ))  # fmt: skip
    compiled = compile_base(replace(base, inputs=(wide,)), inputs=[1e-6])
    points = np.array([-(2**31), -2 * 10**9, -1, 0, 1, 2 * 10**9, 2**31 - 1], dtype=np.int32)
    answers = [Engine(compiled, kind).evaluate([points])[0] for kind in (TABLE, STRAIGHT)]
    exact = evaluate(replace(base, inputs=(wide,)), [compiled.input_value(0, points)]).outputs[0]
    assert np.array_equal(*answers)
    assert np.abs(compiled.output_value(0, answers[0][0]) - exact).max() < compiled.output_lsb(0)
