"""Fuzzy systems of any kind: what readers make of other tools' files, what the integers answer
against float64, C that stands alone, and what is refused."""

import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest
from conftest import ROOT
from quiesce.base.errors import UsageError
from quiesce.cli.main import main
from quiesce.rules.engine.precise import GOOD, compile_precisely, judged
from quiesce.rules.engine.system_engine import SystemEngine
from quiesce.rules.formats.build import NotPlain
from quiesce.rules.formats.files import read_rules, read_system
from quiesce.rules.formats.formula import read_formula
from quiesce.rules.formats.scan import Source
from quiesce.rules.formats.shapes import FLL_SHAPES
from quiesce.rules.model import membership_of
from quiesce.rules.system import model
from quiesce.rules.system.compile import compile_system
from quiesce.rules.system.model import (
    BY_RULE,
    BY_TERM,
    CENTROID,
    WEIGHTED,
    Block,
    Conclusion,
    ConstantTerm,
    Curve,
    Proposition,
    SetTerm,
    System,
    SystemInput,
    SystemOutput,
    SystemRule,
)
from quiesce.rules.system.norms import UNBOUNDED_SUM
from quiesce.rules.system.pieces import ONE_q30, PieceError, pieces_of
from quiesce.rules.system.reference import evaluate
from system_examples import random_curve, random_system

SYSTEMS = sorted((ROOT / "tests/unit/firmware/systems").iterdir())
POINTS = 400
RANDOM_SYSTEMS = 40


# ---- integers against float64 -------------------------------------------------------------------


@pytest.mark.parametrize("number", range(RANDOM_SYSTEMS))
def test_random_systems_answer_like_float64(number: int) -> None:
    found = judged(compile_system(random_system(number), tolerance=2.0**-18))
    # A bisector moves most where its sets are weakest.
    assert found.error < 2e-3 and found.mistaken == 0


@pytest.mark.parametrize("file", SYSTEMS, ids=lambda file: file.name)
def test_systems_of_the_firmware_s_tests_answer_like_float64(file: Path) -> None:
    system = read_system(file)
    found = judged(compile_system(system, tolerance=2.0**-18))
    assert found.error < 1e-3 and found.mistaken == 0


def test_maxima_are_those_of_float64_but_where_two_are_alike() -> None:
    compiled = compile_system(read_system(SYSTEMS[2]), tolerance=2.0**-20)
    system = compiled.system
    rng = np.random.default_rng(11)
    counts = [
        compiled.input_integer(i, rng.uniform(one.minimum, one.maximum, POINTS))
        for i, one in enumerate(system.inputs)
    ]
    out, _ = SystemEngine(compiled).evaluate(counts)
    wanted = evaluate(system, [compiled.input_value(i, one) for i, one in enumerate(counts)])
    for i, output in enumerate(system.outputs):
        off = np.abs(compiled.output_value(i, out[i]) - wanted.outputs[i])
        place = (output.maximum - output.minimum) / output.places
        assert (off <= 1.01 * place).mean() > 0.98, output.name


def test_tables_are_as_fine_as_needed() -> None:
    gaussians = next(file for file in SYSTEMS if file.stem == "gaussians")
    system = read_system(gaussians)
    found = compile_precisely(system)
    assert found.error <= GOOD and found.mistaken == 0
    coarser = compile_system(system, tolerance=2.0**-12)
    assert len(coarser.words) < len(found.compiled.words)
    assert judged(coarser).error > GOOD


# ---- pieces -------------------------------------------------------------------------------------


def test_pieces_keep_their_tolerance_at_every_integer() -> None:
    shape = FLL_SHAPES["Gaussian"]
    curve = Curve("Gaussian", shape([500.0, 90.0]))
    for tolerance in (2.0**-10, 2.0**-16):
        found = pieces_of(curve, lambda x: x, lambda n: n, 0, 1000, tolerance)
        n = np.arange(1001)
        off = np.abs(found.values_q30(n) / ONE_q30 - curve.function(n))
        assert off.max() <= tolerance
        assert found.error == pytest.approx(off.max(), rel=1e-6)


def test_a_vertical_edge_is_exact_and_holds_the_greater_value() -> None:
    points = ((2.0, 0.0), (2.0, 1.0), (5.0, 1.0), (5.0, 0.25))
    curve = Curve("points", lambda x: membership_of(points, x), points)
    found = pieces_of(curve, lambda x: x, lambda n: n, 0, 10, 1e-4)
    quarters = (4 * found.values_q30(np.arange(11)) / ONE_q30).round().tolist()
    assert quarters == [0, 0, 4, 4, 4, 4, 1, 1, 1, 1, 1]


def test_a_curve_that_is_no_number_is_refused() -> None:
    curve = Curve("Function", lambda x: np.log(x - 3.0))
    with pytest.raises(PieceError, match="not a number everywhere"):
        pieces_of(curve, lambda x: x, lambda n: n, 0, 10, 1e-4)


# ---- readers ------------------------------------------------------------------------------------


def written(folder: Path, name: str, text: str) -> Path:
    file = folder / name
    file.write_text(text)
    return file


def test_padded_parameters_and_expressions_of_matlab() -> None:
    system = read_system(next(file for file in SYSTEMS if file.suffix == ".fis"))
    angle = system.inputs[0]
    assert (angle.minimum, angle.maximum) == pytest.approx((-np.pi / 4, np.pi / 4))
    assert angle.terms[1].curve.points == ((-0.3, 0.0), (0.0, 1.0), (0.3, 0.0))
    at = np.array([-np.pi / 8, -np.pi / 8 + 0.2])
    assert angle.terms[0].curve.function(at) == pytest.approx([1.0, np.exp(-0.5)])
    rules = system.rules
    assert rules[1].expression == Proposition(True, 0, 1, ("very",))
    assert rules[2].expression.parts[0] == Proposition(True, 0, 2, ("not",))
    assert rules[2].expression.parts[1] == Proposition(True, 1, 1, ("somewhat",))
    assert rules[3].conclusions[1].hedges == ("very",)
    assert system.blocks[0] == Block("AlgebraicProduct", "AlgebraicSum", "Minimum")


def test_extremely_is_each_tool_s_own(tmp_path: Path) -> None:
    text = next(file for file in SYSTEMS if file.suffix == ".fis").read_text()
    text = text.replace("2.2 0, 2 1", "2.3 0, 2 1")
    octave = read_system(written(tmp_path, "octave.fis", text))
    head = "#Code automatically generated with fuzzylite 6.0.\n"
    fuzzylite = read_system(written(tmp_path, "fuzzylite.fis", head + text))
    assert octave.rules[1].expression.hedges == ("cubed",)
    assert fuzzylite.rules[1].expression.hedges == ("extremely",)


def test_words_of_other_dialects_in_fcl() -> None:
    system = read_system(next(file for file in SYSTEMS if file.suffix == ".fcl"))
    assert [one.method for one in system.outputs] == [
        model.SMALLEST, model.LARGEST, model.MEAN, model.BISECTOR,
    ]  # fmt: skip
    assert system.outputs[1].default is None and system.outputs[3].default == 0.5
    assert (system.inputs[0].minimum, system.inputs[0].maximum) == (-2.0, 100.0)
    assert any("keeps its last value" in note for note in system.notes)
    assert system.blocks[0].implication == "AlgebraicProduct"
    assert system.rules[1].weight == 0.5 and len(system.rules) == 3


def test_a_hedge_of_a_conclusion_lasts_on_in_fll(tmp_path: Path) -> None:
    text = next(file for file in SYSTEMS if file.stem == "norms").read_text()
    rule = "rule: if x is low2 and y is few then u is very back and v is small"
    text = text.replace("rule: if x is low2 and y is few then u is back and v is small", rule)
    first, second = read_system(written(tmp_path, "a.fll", text)).rules[0].conclusions
    assert (first.hedges, second.hedges) == (("very",), ("very",))


def test_what_is_no_plain_base_says_why() -> None:
    for file in SYSTEMS:
        with pytest.raises(NotPlain):
            read_rules(file)


def test_fuzzylite_s_chained_outputs_count_with_what_activates_them() -> None:
    """By hand: u.on by 0.5, then v.big by that."""

    def system(hedges: tuple[str, ...]) -> System:
        curve = Curve("Ramp", lambda x: x, ((0.0, 0.0), (1.0, 1.0)))
        inputs = (SystemInput("x", 0.0, 1.0, (SetTerm("on", curve),)),)
        u = SystemOutput("u", 0.0, 1.0, (ConstantTerm("on", 1.0),), BY_RULE, UNBOUNDED_SUM, 0, 0.0)
        v = SystemOutput(
            "v", 0.0, 1.0, (ConstantTerm("big", 1.0),), WEIGHTED, UNBOUNDED_SUM, 0, 0.0
        )
        rules = (
            SystemRule(0, Proposition(True, 0, 0), (Conclusion(0, 0),), 0.5),
            SystemRule(0, Proposition(False, 0, 0, hedges), (Conclusion(1, 0),)),
        )
        return System("chain", inputs, (u, v), (Block("Minimum", "Maximum", "Minimum"),), rules)

    for hedges, wanted in (((), 0.5), (("very",), 0.25), (("not",), 0.5)):
        compiled = compile_system(system(hedges))
        out, _ = SystemEngine(compiled).evaluate([np.array([32768])])
        assert compiled.output_value(1, out[1])[0] == pytest.approx(wanted, abs=1e-4)
        assert evaluate(system(hedges), [np.array([1.0])]).outputs[1, 0] == pytest.approx(wanted)


@pytest.mark.parametrize(
    ("text", "wanted"),
    [
        ("2*x + 1", 7.0),
        ("-x^2", -9.0),
        ("x^-1*3", 1.0),
        ("sin(pi/2) - cos(0)", 0.0),
        ("max(x, 2) - min(x, 2)", 1.0),
        ("gt(x, 2) + lt(x, 2)", 1.0),
        ("(x + 1) % 3", 1.0),
        ("8/2/2 - 1 - 1", 0.0),
    ],
)
def test_formulas(text: str, wanted: float) -> None:
    formula = read_formula(Source("f", text), 0, len(text))
    assert float(formula({"x": np.array(3.0)})) == pytest.approx(wanted)
    assert formula.names <= {"x"}


# ---- what is refused ----------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("Linear 0.05 0.01 0.25", "Function f*b", "inputs and outputs before it: f, a"),
        ("Linear 0.05 0.01 0.25", "Function log(f-3)", "not a number everywhere"),
        ("Linear -0.02 0.1 2.5", "Linear 1 1", "2 numbers of Linear, expected 3"),
        ("conjunction: AlgebraicProduct", "conjunction: none", "'and' with the operator none"),
        ("disjunction: AlgebraicSum", "disjunction: UnboundedSum", "'or' with the operator"),
        ("activation: General", "activation: Highest 1", "expected 'General'"),
        ("range: 0.000 25.000", "range: 25 25", "minimum < maximum"),
        ("WeightedAverage TakagiSugeno", "Centroid", "aggregation none with Centroid"),
    ],
)
def test_what_no_system_can_hold_is_refused(
    capsys, tmp_path: Path, old: str, new: str, words
) -> None:
    text = next(file for file in SYSTEMS if file.stem == "gaussians").read_text()
    assert old in text
    file = written(tmp_path, "bad.fll", text.replace(old, new, 1))
    out = tmp_path / "out"
    assert main(["rules", "compile", str(file), "--out", str(out)]) == 2
    message = capsys.readouterr().err
    assert words in message and len(message.splitlines()) == 1
    assert not out.exists()


def test_rules_that_must_be_aggregated_one_by_one_are_bounded() -> None:
    system = random_system(2)
    sets = (SetTerm("s", random_curve(np.random.default_rng(1), 0.0, 1.0)),)
    output = SystemOutput("y", 0.0, 1.0, sets, CENTROID, "AlgebraicSum", 50, 0.0)
    rule = SystemRule(0, Proposition(True, 0, 0), (Conclusion(0, 0),))
    many = System("many", system.inputs, (output,), system.blocks, (rule,) * 65)
    with pytest.raises(UsageError, match="65 rules, and an output aggregates them one by one"):
        compile_system(many)


# ---- the command --------------------------------------------------------------------------------


@pytest.mark.parametrize("file", SYSTEMS, ids=lambda file: file.name)
def test_compiled_folder_stands_alone(capsys, tmp_path: Path, file: Path) -> None:
    out = tmp_path / "out"
    assert main(["rules", "compile", str(file), "--out", str(out)]) == 0
    printed = capsys.readouterr()
    assert "taken: the engine for any system" in printed.err
    assert "against float64" in printed.out
    flags = ["-std=c11", "-pedantic", "-Wall", "-Wextra", "-Werror", "-ffreestanding"]
    sources = sorted(str(one) for one in out.glob("*.c"))
    demo = str(tmp_path / "demo")
    subprocess.run(["cc", *flags, "-c", *sources], check=True, cwd=tmp_path)
    subprocess.run(["cc", *flags[:-1], *sources, str(out / "demo/main.c"), "-o", demo], check=True)
    answer = subprocess.run([demo], capture_output=True, text=True)
    assert answer.returncode == 0
    assert answer.stdout.endswith("32 points, 0 values that differ from what they should be\n")


def test_plain_folder_stands_alone_with_cmake(tmp_path: Path) -> None:
    out = tmp_path / "out"
    rules = ROOT / "tools/benchmarks/rules/reference_singleton.fcl"
    assert main(["rules", "compile", str(rules), "--out", str(out)]) == 0
    if shutil.which("cmake") is None:
        pytest.skip("no cmake")
    build = str(tmp_path / "build")
    for command in (["cmake", "-S", str(out), "-B", build], ["cmake", "--build", build]):
        subprocess.run(command, check=True, capture_output=True)
    result = subprocess.run(["ctest", "--test-dir", build], capture_output=True, text=True)
    assert "100% tests passed" in result.stdout


def test_a_wrong_answer_fails_the_demo(tmp_path: Path) -> None:
    out = tmp_path / "out"
    assert main(["rules", "compile", str(SYSTEMS[1]), "--out", str(out)]) == 0
    main_c = out / "demo/main.c"
    text = main_c.read_text()
    row = next(line for line in text.splitlines() if line.startswith("    {{"))
    values = row.split("{")[-1].split("}")[0]
    main_c.write_text(text.replace(row, row.replace(f"{{{values}}}", f"{{{int(values) + 1}}}"), 1))
    demo = str(tmp_path / "demo")
    sources = [str(one) for one in out.glob("*.c")]
    subprocess.run(["cc", *sources, str(main_c), "-o", demo], check=True)
    answer = subprocess.run([demo], capture_output=True, text=True)
    assert answer.returncode == 1 and "1 values that differ" in answer.stdout


def test_answers_that_integers_cannot_give_are_refused(capsys, tmp_path: Path) -> None:
    file = next(file for file in SYSTEMS if file.stem == "gaussians")
    out = tmp_path / "out"
    assert main(["rules", "compile", str(file), "--out", str(out), "--max-error", "1e-6"]) == 2
    message = capsys.readouterr().err
    assert "--max-error 1 takes it as it is" in message and len(message.splitlines()) == 1
    assert not out.exists()
    assert main(["rules", "compile", str(file), "--out", str(out), "--max-error", "100"]) == 0


def test_tsukamoto_of_one_input_is_a_function_of_it() -> None:
    """The inverse of a sigmoid at a strength next to 1 turns on its last digits."""
    curve = Curve("Bell", lambda x: 1.0 / (1.0 + np.abs(x / 0.5) ** 6), None, (0.0,))
    inputs = (SystemInput("x", -1.0, 1.0, (SetTerm("near", curve),)),)
    value = Curve("Sigmoid", lambda w: 0.5 + np.log(1.0 / np.clip(w, 1e-9, 1 - 1e-9) - 1.0) / -30.0)
    output = SystemOutput(
        "y", 0.0, 1.0, (model.StrengthTerm("a", value),), BY_TERM, "Maximum", 0, 0.0
    )
    rules = (SystemRule(0, Proposition(True, 0, 0), (Conclusion(0, 0),)),)
    blocks = (Block("Minimum", "Maximum", "Minimum"),)
    system = System("one", inputs, (output,), blocks, rules)
    assert compile_precisely(system).error < GOOD
    twice = System("two", inputs, (output,), blocks, rules * 2)
    assert compile_precisely(twice).error > GOOD


def test_what_asks_for_a_plain_base_says_so(capsys) -> None:
    file = str(SYSTEMS[1])
    for arguments in (
        ["compile", file, "--controller", "--approximate", "8"],
        ["check", file, "--controller"],
        ["diff", file, file],
    ):
        assert main(["rules", *arguments]) == 2
        message = capsys.readouterr().err
        assert len(message.splitlines()) == 1 and "gaussians.fll:" in message


# ---- what was wrong once ------------------------------------------------------------------------

SMALL = """Engine: small
InputVariable: a
  range: 0 100000
  term: lo Gaussian 30190 5
  term: hi Ramp 0 100000
OutputVariable: o
  range: 0 1
  aggregation: none
  defuzzifier: WeightedAverage
  default: nan
  term: p Constant 1
  term: q Constant 0
RuleBlock:
  conjunction: AlgebraicProduct
  disjunction: AlgebraicSum
  implication: none
  activation: General
  rule: if a is lo then o is p
  rule: if a is any then o is q with 0.2
"""


def edited(tmp_path: Path, *edits: tuple[str, str]) -> Path:
    text = SMALL
    for old, new in edits:
        assert old in text
        text = text.replace(old, new)
    return written(tmp_path, "small.fll", text)


def test_a_narrow_set_in_a_wide_universe_is_not_overlooked(tmp_path: Path) -> None:
    for term in (
        "Gaussian 30190 5",
        "SigmoidProduct 30170 2 -2 30200",
        "Function ge(x,30190)*le(x,30200)",
    ):
        system = read_system(edited(tmp_path, ("Gaussian 30190 5", term)))
        compiled = compile_system(system)
        counts = np.arange(32769)
        out, _ = SystemEngine(compiled).evaluate([counts])
        wanted = evaluate(system, [compiled.input_value(0, counts)]).outputs[0]
        assert wanted.max() > 0.8
        assert np.abs(compiled.output_value(0, out[0]) - wanted).max() < 2e-3


def answers(file: Path, *x: float) -> list[float]:
    return evaluate(read_system(file), [np.array(x)]).outputs[0].tolist()


def test_sets_of_takagi_and_sugeno_are_not_tsukamoto_s(tmp_path: Path) -> None:
    value = ("term: p Constant 1\n  term: q Constant 0", "term: p Ramp 0 2")
    rule = (
        "rule: if a is lo then o is p\n  rule: if a is any then o is q with 0.2",
        "rule: if a is hi then o is p",
    )
    x = (25000.0, 75000.0)
    assert answers(edited(tmp_path, value, rule), *x) == pytest.approx([0.5, 1.5])
    as_sets = (*(value, rule), ("WeightedAverage", "WeightedAverage TakagiSugeno"))
    assert answers(edited(tmp_path, *as_sets), *x) == pytest.approx([0.125, 0.375])
    low = (("term: p Constant 1\n  term: q Constant 0", "term: p Ramp 0 2 0.5"), rule)
    assert answers(edited(tmp_path, *low), *x) == pytest.approx([1.0, 3.0])


def test_smallest_and_largest_of_matlab_are_by_magnitude(tmp_path: Path) -> None:
    text = next(file for file in SYSTEMS if file.suffix == ".fis").read_text()
    text = text.replace("MF3='all':'constant',[9.5]", "MF3='all':'trimf',[8 9 10]")
    text = text.replace("MF1='none':'constant',[0 0 0]", "MF1='none':'trimf',[-20 -15 -10]")
    text = text.replace(
        "MF2='as it moves':'linear',[4 0.25 -1]", "MF2='as it moves':'trimf',[-9 -5 0]"
    )
    text = text.replace("'wtaver'", "'som'").replace("Range=[-20 20]", "Range=[-20 0]")
    found = read_system(written(tmp_path, "som.fis", text))
    assert [one.method for one in found.outputs] == [model.SMALLEST, model.LARGEST]
    with pytest.raises(UsageError, match="som is by magnitude, and output pull has both signs"):
        read_system(written(tmp_path, "both.fis", text.replace("Range=[-20 0]", "Range=[-20 1]")))


@pytest.mark.parametrize(
    ("edits", "words"),
    [
        ([("q Constant 0", "q Ramp 0 1")], "terms of several types"),
        ([("aggregation: none", "aggregation: Maximum"), ("WeightedAverage", "WeightedSum"),
          ("any then o is q", "any then o is p")], "and two rules of a term"),
        ([("p Constant 1", "p Function 1/0")], "a formula that is no number"),
        ([("p Constant 1", "p Function 1" + "+1" * 201)], "at most 200 operators"),
        ([("lo Gaussian 30190 5", "lo Function x" + "+x" * 201)], "at most 200 operators"),
        ([("range: 0 100000", "range: 0 1e-300")], "expected a wider one"),
        ([("p Constant 1", "p Linear 1 0"),
          ("RuleBlock:", "InputVariable: b\n  range: 0 1\nRuleBlock:")], "2 numbers of Linear"),
        ([("RuleBlock:\n", "RuleBlock:\n  activation: General\n" * 255 + "RuleBlock:\n")],
         "256 rule blocks; at most 255"),
    ],
)  # fmt: skip
def test_what_once_ended_in_a_trace_is_one_line(capsys, tmp_path: Path, edits, words) -> None:
    file = edited(tmp_path, *edits)
    assert main(["rules", "compile", str(file), "--out", str(tmp_path / "out")]) == 2
    message = capsys.readouterr().err
    assert words in message and len(message.splitlines()) == 1


@pytest.mark.parametrize("number", ["1/0", "0/0", "10^400", "-10^300"])
def test_expression_that_is_no_number_of_a_file_is_refused(tmp_path: Path, number: str) -> None:
    text = next(file for file in SYSTEMS if file.suffix == ".fis").read_text()
    file = written(tmp_path, "bad.fis", text.replace("[0.2 -pi/8 0 0]", f"[0.2 {number} 0 0]"))
    with pytest.raises(UsageError, match=r"bad.fis:19:27: number '.*', expected one within"):
        read_system(file)


def test_an_operator_that_no_rule_needs_may_be_any(tmp_path: Path) -> None:
    file = edited(tmp_path, ("disjunction: AlgebraicSum", "disjunction: UnboundedSum"))
    SystemEngine(compile_system(read_system(file)))
