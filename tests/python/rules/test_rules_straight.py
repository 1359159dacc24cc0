"""Straight-line C of systems: polynomials in integers against exact arithmetic, what it answers
against float64 and within what is proved, C that stands alone, and what has no such form."""

import subprocess
from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from conftest import ROOT
from quiesce.cli.main import main
from quiesce.rules.engine.function_engine import FunctionEngine
from quiesce.rules.engine.precise import judged
from quiesce.rules.formats.files import read_system
from quiesce.rules.model import AND, OR, membership_of, trapezoid
from quiesce.rules.straight.compile import (
    JOINS,
    NotStraight,
    StraightSystem,
    compile_straight,
    why_not_straight,
)
from quiesce.rules.straight.emit import straight_line
from quiesce.rules.straight.horner import (
    LIMIT,
    ONE,
    Variable,
    centred_form,
    finest_bits,
    lifted_form,
)
from quiesce.rules.straight.polynomial import Polynomial, collected, constant, variable
from quiesce.rules.straight.region import region_of
from quiesce.rules.system.model import (
    BY_RULE,
    BY_TERM,
    CENTROID,
    WEIGHTED,
    Block,
    Complement,
    Conclusion,
    ConstantTerm,
    Curve,
    Join,
    LinearTerm,
    Proposition,
    SetTerm,
    System,
    SystemInput,
    SystemOutput,
    SystemRule,
)
from quiesce.rules.system.norms import ALGEBRAIC_PRODUCT, MAXIMUM, MINIMUM, UNBOUNDED_SUM
from quiesce.rules.system.reference import evaluate

RULES = ROOT / "tools/benchmarks/rules"
SUGENO, PRODUCT = RULES / "reference_sugeno.fis", RULES / "reference_product.fis"
RANDOM_SYSTEMS = 18
POINTS = 3000
WEAKEST = 2.0**-10  # strength from which an answer is judged that has no bound
FLOAT_ERROR = 1e-6  # counts: of the float64 reference


# ---- polynomials --------------------------------------------------------------------------------


def random_polynomial(rng: np.random.Generator, names: str) -> Polynomial:
    terms = []
    for _ in range(int(rng.integers(1, 8))):
        powers = {name: int(rng.integers(0, 3)) for name in names}
        monomial = tuple((name, power) for name, power in powers.items() if power)
        terms.append((monomial, Fraction(int(rng.integers(-(10**6), 10**6)), 997)))
    return collected(terms)


def value_of(text: str, values: dict[str, int]) -> int:
    """Of C made of fuzzy_step()."""
    return eval(text, {"fuzzy_step": lambda base, by, t: base + (by * t >> 32), **values})


@pytest.mark.parametrize("number", range(40))
def test_integer_polynomials_keep_their_bounds(number: int) -> None:
    rng = np.random.default_rng([7, number])
    names = "tuv"[: int(rng.integers(1, 4))]
    polynomial = random_polynomial(rng, names)
    ends = {n: sorted(int(x) for x in rng.integers(-(2**31), 2**31, 2)) for n in names}
    variables = {n: Variable(*both) for n, both in ends.items()}
    bits = finest_bits(polynomial, variables)
    assert bits is not None
    for form in (
        centred_form(polynomial, variables, bits),
        lifted_form(polynomial, variables, bits),
    ):
        assert form.widest <= LIMIT
        for _ in range(50):
            at = {n: int(rng.integers(*both, endpoint=True)) for n, both in ends.items()}
            found = value_of(form.text, at)
            exact = (
                polynomial.at({n: Fraction(k, ONE) for n, k in at.items()}) * Fraction(2) ** bits
            )
            assert form.least <= found <= form.most
            assert form.below <= found - exact <= form.above
    assert lifted_form(polynomial, variables, bits).below >= 0


def test_finest_bits_are_the_finest() -> None:
    polynomial = variable("t") * 3 + constant(5)
    variables = {"t": Variable(-(2**31), 2**31 - 1)}
    bits = finest_bits(polynomial, variables)
    assert centred_form(polynomial, variables, bits).widest <= LIMIT
    assert centred_form(polynomial, variables, bits + 1).widest > LIMIT
    assert finest_bits(constant(Fraction(2) ** 70), {}) is None


def test_polynomials_of_a_box_lie_in_their_range() -> None:
    rng = np.random.default_rng(5)
    for _ in range(30):
        polynomial = random_polynomial(rng, "tu")
        ends = {n: sorted(Fraction(int(x), 8) for x in rng.integers(-8, 8, 2)) for n in "tu"}
        low, high = polynomial.range({n: tuple(both) for n, both in ends.items()})
        for share in np.ndindex(5, 5):
            at = {
                n: both[0] + (both[1] - both[0]) * Fraction(k, 4)
                for (n, both), k in zip(ends.items(), map(int, share), strict=True)
            }
            assert low <= polynomial.at(at) <= high


def test_a_region_is_a_polygon() -> None:
    """0 <= u <= v and u + v <= 1: a triangle, with 2 u + v between 0 and 3/2."""
    u, v = variable("u"), variable("v")
    box = {"u": (Fraction(0), Fraction(1)), "v": (Fraction(0), Fraction(1))}
    region = region_of(box, [u - v, u + v - constant(1)])
    assert region.box["u"] == (0, Fraction(1, 2)) and region.box["v"] == (0, 1)
    assert region.range(u * 2 + v) == (0, Fraction(3, 2))


# ---- against float64 ----------------------------------------------------------------------------


def as_set(name: str, points) -> SetTerm:
    points = tuple(points)
    return SetTerm(name, Curve("points", lambda x: membership_of(points, x), points))


def random_input(rng: np.random.Generator, number: int, of: int) -> SystemInput:
    """Sets that add up to 1, or lie anywhere; few where it is one of many inputs."""
    low = float(rng.uniform(-10, 10))
    high = low + float(rng.uniform(0.5, 20))
    count = 2 if of == 3 else int(rng.integers(2, 5))
    if rng.random() < 0.6:
        tops = (
            np.linspace(low, high, count)
            if rng.random() < 0.5
            else np.sort(rng.uniform(low, high, count))
        )
        before = [float("-inf"), *tops[:-1]]
        after = [*tops[1:], float("inf")]
        sets = [trapezoid("s", a, b, b, c) for a, b, c in zip(before, tops, after, strict=True)]
    else:
        span = high - low
        corners = np.sort(rng.uniform(low - 0.2 * span, high + 0.2 * span, (count, 4)))
        sets = [trapezoid("s", *map(float, row)) for row in corners]
    terms = tuple(as_set(f"s{k}", one.points) for k, one in enumerate(sets))
    return SystemInput(f"in{number}", low, high, terms)


def random_expression(rng: np.random.Generator, inputs, depth: int = 0):
    if depth == 2 or rng.random() < 0.3:
        index = int(rng.integers(len(inputs)))
        hedges = ("not",) if rng.random() < 0.2 else ()
        return Proposition(True, index, int(rng.integers(len(inputs[index].terms))), hedges)
    parts = tuple(random_expression(rng, inputs, depth + 1) for _ in range(2))
    joined = Join(AND if rng.random() < 0.7 else OR, parts)
    return Complement(joined) if rng.random() < 0.15 else joined


def random_output(rng: np.random.Generator, number: int, inputs: int) -> SystemOutput:
    method = str(rng.choice([BY_RULE, BY_RULE, BY_TERM, WEIGHTED]))
    low, high = -float(rng.uniform(0, 5)), float(rng.uniform(1, 5))
    terms = tuple(
        LinearTerm(
            f"l{k}", tuple(rng.uniform(-0.3, 0.3, inputs).tolist()), float(rng.uniform(low, high))
        )
        if rng.random() < 0.5
        else ConstantTerm(f"c{k}", float(rng.uniform(low, high)))
        for k in range(int(rng.integers(2, 5)))
    )
    norm = MAXIMUM if method == BY_TERM else UNBOUNDED_SUM
    return SystemOutput(
        f"out{number}", low, high, terms, method, norm, 0, 0.0, bool(rng.random() < 0.3)
    )


def random_system(number: int) -> System:
    rng = np.random.default_rng([61, number])
    most = int(rng.choice([1, 2, 2, 2, 3]))
    inputs = tuple(random_input(rng, i, most) for i in range(most))
    outputs = tuple(random_output(rng, k, len(inputs)) for k in range(int(rng.integers(1, 3))))
    conjunction = ALGEBRAIC_PRODUCT if rng.random() < 0.6 else MINIMUM
    disjunction = str(rng.choice([MAXIMUM, "AlgebraicSum"]))
    blocks = (Block(conjunction, disjunction, MINIMUM),)
    if rng.random() < 0.6:  # every combination of the first two inputs
        ends = [range(len(one.terms)) for one in inputs[:2]]
        expressions = [
            Join(AND, tuple(Proposition(True, i, k) for i, k in enumerate(place)))
            if len(place) > 1
            else Proposition(True, 0, place[0])
            for place in np.ndindex(*map(len, ends))
        ]
    else:
        expressions = [random_expression(rng, inputs) for _ in range(int(rng.integers(2, 7)))]
    rules = tuple(
        SystemRule(
            0,
            expression,
            tuple(
                Conclusion(k, int(rng.integers(len(one.terms)))) for k, one in enumerate(outputs)
            ),
            float(rng.choice([1.0, 1.0, 0.5])),
        )
        for expression in expressions
    )
    return System(f"random {number}", inputs, outputs, blocks, rules)


def points_of(compiled: StraightSystem, seed: int) -> list[np.ndarray]:
    """Random counts, the ends of stretches and int32's."""
    rng = np.random.default_rng(seed)
    found = []
    for i, one in enumerate(compiled.system.inputs):
        drawn = compiled.input_integer(i, rng.uniform(one.minimum, one.maximum, POINTS))
        ends = [end for part in compiled.stretches[i] for end in (part.first, part.last)]
        found.append(rng.permutation(np.concatenate([drawn, rng.choice(ends, POINTS // 2)])))
    return found


def counts_off(compiled: StraightSystem, points: list[np.ndarray]):
    """[output, point]: how far the integers are off, in counts; which have their default here and
    in the reference; how strongly rules fire."""
    out, defaults = FunctionEngine(compiled).evaluate(points)
    x = []
    for i, (one, axis) in enumerate(zip(compiled.system.inputs, compiled.axes, strict=True)):
        low, high = axis.position(one.minimum), axis.position(one.maximum)
        exact = [axis.origin + min(max(Fraction(int(n)), low), high) * axis.lsb for n in points[i]]
        x.append(np.array([float(value) for value in exact]))
    wanted = evaluate(compiled.system, x)
    off, is_default = [], []
    for i, axis in enumerate(compiled.output_axes):
        counts = (wanted.outputs[i] - float(axis.origin)) / float(axis.lsb)
        off.append(np.abs(out[i] - counts))
        is_default.append((defaults >> i & 1) > 0)
    return np.array(off), np.array(is_default), wanted


@pytest.mark.parametrize("number", range(RANDOM_SYSTEMS))
def test_random_systems_answer_as_proved_and_like_float64(number: int) -> None:
    system = random_system(number)
    compiled = compile_straight(system)
    off, is_default, wanted = counts_off(compiled, points_of(compiled, number))
    for i, error in enumerate(straight_line(compiled).errors):
        never, surely = wanted.strongest[i] == 0.0, wanted.strongest[i] >= WEAKEST
        assert is_default[i][never].all() and not is_default[i][surely].any()
        assert off[i][surely].max(initial=0.0) < 8.0
        if error is not None:
            assert off[i][~is_default[i] & ~never].max(initial=0.0) <= float(error) + FLOAT_ERROR


def test_most_random_systems_are_proved() -> None:
    proved = [
        all(error is not None for error in straight_line(compile_straight(random_system(k))).errors)
        for k in (1, 2, 4, 6, 7, 10, 17)  # those that are compiled in a moment
    ]
    assert sum(proved) > len(proved) // 2


@pytest.mark.parametrize("forms", [None, (["1e-6", "1e-6"], ["1e-3"]), (["0.5", "1e-7"], ["5e-7"])])
@pytest.mark.parametrize("conjunction", [ALGEBRAIC_PRODUCT, MINIMUM])
@pytest.mark.parametrize("file", [SUGENO, PRODUCT], ids=lambda file: file.stem)
def test_reference_controllers_keep_what_is_proved(file: Path, conjunction: str, forms) -> None:
    system = read_system(file)
    blocks = tuple(replace(one, conjunction=conjunction) for one in system.blocks)
    compiled = compile_straight(replace(system, blocks=blocks), *(forms or ()))
    made = straight_line(compiled)
    off, is_default, _ = counts_off(compiled, points_of(compiled, 3))
    assert not is_default.any()
    assert made.errors[0] is not None and off.max() <= float(made.errors[0]) + FLOAT_ERROR
    assert made.errors[0] < Fraction(9, 8)
    assert (made.divided == 0) == (conjunction == ALGEBRAIC_PRODUCT)


def test_products_of_sets_that_add_up_to_one_do_not_divide() -> None:
    text = straight_line(compile_straight(read_system(PRODUCT))).text("f")
    assert "/" not in text.replace("//", "") and "quotient" not in text


def test_three_inputs_with_minima_are_found_at_run_time() -> None:
    sets = (as_set("low", ((0.0, 1.0), (1.0, 0.0))), as_set("high", ((0.0, 0.0), (1.0, 1.0))))
    inputs = tuple(SystemInput(name, 0.0, 1.0, sets) for name in "xyz")
    terms = tuple(LinearTerm(f"l{k}", (0.1 * k, 0.2, -0.1), 0.1 * k) for k in range(8))
    output = SystemOutput("u", -1.0, 2.0, terms, BY_RULE, UNBOUNDED_SUM, 0, 0.0)
    rules = tuple(
        SystemRule(
            0,
            Join(AND, tuple(Proposition(True, i, k >> i & 1) for i in range(3))),
            (Conclusion(0, k),),
        )
        for k in range(8)
    )
    system = System("cube", inputs, (output,), (Block(MINIMUM, MAXIMUM, MINIMUM),), rules)
    compiled = compile_straight(system)
    assert "fuzzy_lesser" in straight_line(compiled).text("f")
    off, is_default, _ = counts_off(compiled, points_of(compiled, 9))
    assert off.max() < 1.0 and not is_default.any()


# ---- what has no such form ----------------------------------------------------------------------


def changed(system: System, **outputs) -> System:
    return replace(system, outputs=tuple(replace(one, **outputs) for one in system.outputs))


def with_first_rule(system: System, rule: SystemRule) -> System:
    return replace(system, rules=(rule, *system.rules[1:]))


def test_what_is_not_straight_says_why() -> None:
    system = read_system(SUGENO)
    assert why_not_straight(system) == ""
    first = system.rules[0]
    smooth = SetTerm("bell", Curve("Gaussian", np.exp))
    own = system.inputs[0]
    cases = {
        "5 inputs; straight-line C takes 4": replace(system, inputs=(own,) * 5),
        "set bell of input f is not made of straight lines": replace(
            system, inputs=(replace(own, terms=(smooth,)), system.inputs[1])
        ),
        "output I is the centroid of sets": changed(system, method=CENTROID),
        "output I has values that are no straight lines": changed(system, terms=(smooth,)),
        "output I aggregates by AlgebraicSum": changed(
            system, method=BY_TERM, aggregation="AlgebraicSum"
        ),
        "rule 1 looks at an output": with_first_rule(
            system, replace(first, expression=Proposition(False, 0, 0))
        ),
        "rule 1 has the hedge very": with_first_rule(
            system, replace(first, expression=Proposition(True, 0, 0, ("very",)))
        ),
        "rule 1 has a hedge in its conclusion": with_first_rule(
            system, replace(first, conclusions=(Conclusion(0, 0, ("very",)),))
        ),
        "rule 1 joins by HamacherProduct": replace(
            system, blocks=(replace(system.blocks[0], conjunction="HamacherProduct"),)
        ),
    }
    assert "HamacherProduct" not in JOINS
    for words, case in cases.items():
        assert words in why_not_straight(case)
        with pytest.raises(NotStraight, match=words.split(";")[0]):
            compile_straight(case)


def test_too_many_combinations_are_refused() -> None:
    tops = np.linspace(0.0, 1.0, 25)
    sets = tuple(
        as_set(f"s{k}", trapezoid("s", top - 0.03, top, top, top + 0.03).points)
        for k, top in enumerate(tops.tolist())
    )
    system = read_system(PRODUCT)
    wide = replace(system, inputs=tuple(replace(one, terms=sets) for one in system.inputs))
    with pytest.raises(NotStraight, match="combinations of stretches"):
        compile_straight(wide)


def test_values_beyond_32_bits_are_refused() -> None:
    system = read_system(PRODUCT)
    terms = (ConstantTerm("far", 1e9), *system.outputs[0].terms[1:])
    with pytest.raises(NotStraight, match="output I: its values leave 32 bits"):
        straight_line(compile_straight(changed(system, terms=terms)))


# ---- the command --------------------------------------------------------------------------------


@pytest.mark.parametrize("file", [SUGENO, PRODUCT], ids=lambda file: file.stem)
def test_compiled_folder_stands_alone(capsys, tmp_path: Path, file: Path) -> None:
    out = tmp_path / "out"
    assert main(["rules", "compile", str(file), "--name", "own", "--out", str(out)]) == 0
    printed = capsys.readouterr()
    assert "expected 'min'; taken: straight-line C of polynomials" in printed.err
    assert "against float64" in printed.out and "0 with a division" in printed.out
    assert "bound      0.00076 % of an output's range" in printed.out
    assert {one.name for one in out.iterdir()} == {
        "own.h", "own.c", "fuzzy_polynomial.h", "fuzzy_math.h", "fixq.h", "demo", "CMakeLists.txt",
        "README.md",
    }  # fmt: skip
    flags = ["-std=c11", "-pedantic", "-Wall", "-Wextra", "-Wconversion", "-Werror"]
    demo = str(tmp_path / "demo")
    subprocess.run(
        ["cc", *flags, "-ffreestanding", "-c", str(out / "own.c")], check=True, cwd=tmp_path
    )
    sources = [str(out / "own.c"), str(out / "demo/main.c")]
    subprocess.run(["cc", *flags, *sources, "-o", demo], check=True)
    answer = subprocess.run([demo], capture_output=True, text=True)
    assert answer.returncode == 0
    assert answer.stdout.endswith("32 points, 0 values that differ from what they should be\n")


def test_a_table_is_made_where_it_is_asked_for(capsys, tmp_path: Path) -> None:
    out = tmp_path / "out"
    assert main(["rules", "compile", str(SUGENO), "--table", "--out", str(out)]) == 0
    printed = capsys.readouterr()
    assert "taken: the engine for any system" in printed.err
    assert "reference_sugeno_table" in printed.out and (out / "fuzzy_system.c").is_file()


def test_a_smooth_set_takes_the_engine_and_says_why(capsys, tmp_path: Path) -> None:
    file = ROOT / "tests/unit/firmware/systems/gaussians.fll"
    assert main(["rules", "compile", str(file), "--out", str(tmp_path / "out")]) == 0
    err = capsys.readouterr().err
    assert "no straight-line C: set S of input f is not made of straight lines; taken" in err


def test_an_error_that_is_too_large_is_refused(capsys, tmp_path: Path) -> None:
    out = tmp_path / "out"
    assert main(["rules", "compile", str(SUGENO), "--max-error", "1e-6", "--out", str(out)]) == 2
    assert len(capsys.readouterr().err.splitlines()) == 1 and not out.exists()


def test_judged_is_the_same_measure_for_both_forms() -> None:
    compiled = compile_straight(read_system(SUGENO))
    found = judged(compiled)
    bound = float(straight_line(compiled).errors[0] * compiled.output_axes[0].lsb) / 5.0
    assert 0.0 < found.error <= bound and found.mistaken == 0
