"""Values that are formulas of several variables: integers against float64, and what is refused."""

from pathlib import Path

import numpy as np
import pytest
from conftest import ROOT
from quiesce.base.errors import UsageError
from quiesce.cli.main import main
from quiesce.rules.engine.precise import GOOD, compile_precisely
from quiesce.rules.engine.system_engine import SystemEngine
from quiesce.rules.formats.files import read_system
from quiesce.rules.system.compile import CompiledSystem, compile_system
from quiesce.rules.system.formula import Apply, Name, Number, Tree, names_of, value_of
from quiesce.rules.system.model import FormulaTerm, InputTerm, System
from quiesce.rules.system.reference import evaluate

VARIABLES = ROOT / "tests/unit/firmware/systems/variables.fll"
POINTS = 500
RANDOM_FORMULAS = 20

SMALL = """Engine: small
InputVariable: a
  range: -2 3
  term: on Ramp -2 3
  term: off Ramp 3 -2
InputVariable: b
  range: 0.5 4
OutputVariable: first
  range: -50 50
  aggregation: none
  defuzzifier: WeightedAverage TakagiSugeno
  default: 7
  term: p Function a*b
  term: q Constant 1
OutputVariable: second
  range: -50 50
  aggregation: none
  defuzzifier: WeightedAverage TakagiSugeno
  default: 0
  term: p Function first + 2*b
RuleBlock:
  conjunction: AlgebraicProduct
  disjunction: AlgebraicSum
  implication: none
  activation: General
  rule: if a is any then first is p
  rule: if a is any then second is p
"""


def small(folder: Path, *edits: tuple[str, str]) -> System:
    text = SMALL
    for old, new in edits:
        assert old in text
        text = text.replace(old, new, 1)
    file = folder / "small.fll"
    file.write_text(text)
    return read_system(file)


def answers(compiled: CompiledSystem, *x: float) -> list[float]:
    counts = [np.array([compiled.input_integer(i, one)]) for i, one in enumerate(x)]
    out, _ = SystemEngine(compiled).evaluate(counts)
    return [float(compiled.output_value(i, one[0])) for i, one in enumerate(out)]


# ---- integers against float64 --------------------------------------------------------------------


def random_tree(rng: np.random.Generator, depth: int = 0) -> Tree:
    """Of a (-2 .. 3) and b (0.5 .. 4); a number everywhere."""
    if depth == 3 or rng.random() < 0.2:
        name = Name(str(rng.choice(["a", "b"])))
        return name if rng.random() < 0.7 else Number(float(rng.uniform(-2, 2)))
    first, second = random_tree(rng, depth + 1), random_tree(rng, depth + 1)
    word = str(rng.choice(["+", "-", "*", "min", "max", "/", "abs", "sin", "tanh", "negate", "^"]))
    if word in ("+", "-", "*", "min", "max"):
        return Apply(word, (first, second))
    if word == "/":
        return Apply("/", (first, Apply("+", (Number(1.5), Apply("^", (second, Number(2.0)))))))
    if word == "^":
        return Apply("^", (first, Number(2.0)))
    return Apply(word, (first,))


def with_formula(system: System, tree: Tree) -> System:
    """The system with this for first's term p, and a range that fits."""
    rng = np.random.default_rng(3)
    drawn = {one.name: rng.uniform(one.minimum, one.maximum, 4000) for one in system.inputs}
    values = np.broadcast_to(value_of(tree, drawn), 4000)
    low, high = float(values.min()), float(values.max())
    names = names_of(tree)
    places = tuple((one.name, i) for i, one in enumerate(system.inputs) if one.name in names)
    term = FormulaTerm("p", tree, places)
    output = system.outputs[0].__class__(
        "first", low - 0.1, max(high, low + 1.0) + 0.1, (term,), system.outputs[0].method,
        system.outputs[0].aggregation, 0, low,
    )  # fmt: skip
    return System("random", system.inputs, (output,), system.blocks, system.rules[:1])


@pytest.mark.parametrize("number", range(RANDOM_FORMULAS))
def test_random_formulas_answer_like_float64(tmp_path: Path, number: int) -> None:
    rng = np.random.default_rng([77, number])
    tree = random_tree(rng)
    while len(names_of(tree)) < 2:
        tree = random_tree(rng)
    precise = compile_precisely(with_formula(small(tmp_path), tree))
    assert precise.error < GOOD and precise.mistaken == 0


def test_the_firmware_s_case_is_good_and_small() -> None:
    precise = compile_precisely(read_system(VARIABLES))
    assert precise.error < GOOD and precise.mistaken == 0
    assert 4 * len(precise.compiled.words) < 8192


def test_an_output_counts_as_it_comes_out(tmp_path: Path) -> None:
    compiled = compile_system(small(tmp_path))
    assert answers(compiled, 1.5, 2.0) == pytest.approx([3.0, 7.0], abs=4e-3)
    # Where no rule of it fires, by its default.
    silent = small(tmp_path, ("if a is any then first is p", "if a is on then first is p"))
    assert answers(compile_system(silent), -2.0, 2.0) == pytest.approx([7.0, 11.0], abs=4e-3)
    # Limited to its range, where the file says so.
    clipped = small(tmp_path, ("  range: -50 50", "  range: 0 2\n  lock-range: true"),
                    ("default: 7", "default: 1"))  # fmt: skip
    found = answers(compile_system(clipped), 3.0, 4.0)
    assert found == pytest.approx([2.0, 10.0], abs=4e-3)
    assert evaluate(clipped, [np.array([3.0]), np.array([4.0])]).outputs[:, 0].tolist() == [2, 10]


def test_rules_of_one_term_add_up_to_four(tmp_path: Path) -> None:
    rule = "  rule: if a is any then second is p\n"
    three = small(tmp_path, (rule, rule * 3))
    assert answers(compile_system(three), 1.5, 2.0)[1] == pytest.approx(7.0, abs=4e-3)
    with pytest.raises(UsageError, match="at most 4 rules a term"):
        compile_system(small(tmp_path, (rule, rule * 5)))


def test_a_hole_of_a_formula_is_filled_with_its_limit(tmp_path: Path) -> None:
    system = small(tmp_path, ("Function a*b", "Function sin(a)/a"))
    assert isinstance(system.outputs[0].terms[0], InputTerm)
    assert evaluate(system, [np.zeros(1), np.ones(1)]).outputs[0, 0] == pytest.approx(1.0)
    precise = compile_precisely(system, [0.125, 0.125])
    assert answers(precise.compiled, 0.0, 1.0)[0] == pytest.approx(1.0, abs=4e-3)


# ---- what is refused -----------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("Function a*b", "Function a*c", "a formula with c, expected inputs and outputs before it"),
        ("Function a*b", "Function a*first", "a formula with first, expected inputs"),
        ("Function a*b", "Function a*second", "a formula with second, expected inputs"),
        ("Function a*b", "Function a/(b - a)", "Function: not a number everywhere"),
        ("Function a*b", "Function fmod(a, b)", "Function: fmod of two things that vary"),
        ("Function a*b", "Function b^a", "Function: ^ of two things that vary"),
        ("Function a*b", "Function log(a*b)", "Function: not a number everywhere"),
        ("Function a*b", "Function exp(exp(a*b*9))", "Function: not a number everywhere"),
        ("Function a*b", "Function a*b" + " + a*b" * 70, "operations, at most 64"),
        ("Function a*b", "Function " + "a*(b+" * 9 + "a" + ")" * 9, "nested too deeply"),
    ],
)  # fmt: skip
def test_formulas_that_integers_cannot_follow(
    capsys, tmp_path: Path, old: str, new: str, words: str
) -> None:
    file = tmp_path / "bad.fll"
    file.write_text(SMALL.replace(old, new, 1))
    assert main(["rules", "compile", str(file), "--out", str(tmp_path / "out")]) == 2
    message = capsys.readouterr().err
    assert words in message and len(message.splitlines()) == 1
    assert not (tmp_path / "out").exists()


def test_a_weighted_sum_names_no_outputs(tmp_path: Path) -> None:
    text = SMALL[SMALL.index("OutputVariable: second") :]
    system = small(tmp_path, (text, text.replace("WeightedAverage", "WeightedSum")))
    with pytest.raises(UsageError, match="only a weighted average of constants and formulas can"):
        compile_system(system)


def test_check_and_show_take_formulas(capsys, tmp_path: Path) -> None:
    small(tmp_path)
    file = str(tmp_path / "small.fll")
    assert main(["rules", "check", file, "--quick"]) == 0
    out = capsys.readouterr().out
    assert "no rule asks for input b" not in out and out.splitlines()[-1].split()[-1] == "ok"
    assert main(["rules", "show", file, "--out", str(tmp_path / "show")]) == 0


def test_a_formula_of_an_output_without_a_value_is_no_fault_of_the_integers(
    capsys, tmp_path: Path
) -> None:
    edits = [("default: 7", "default: nan"), ("if a is any then first", "if a is on then first")]
    small(tmp_path, *edits)
    assert main(["rules", "check", str(tmp_path / "small.fll"), "--quick"]) == 1
    out = capsys.readouterr().out
    assert "error      no rule for first fires where a = -2" in out
    assert out.splitlines()[-1].split(maxsplit=1)[1] == "1 finding is an error"
