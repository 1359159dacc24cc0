"""Rule files: what each format says, in any style of writing."""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from conftest import ROOT
from quiesce.base.errors import UsageError
from quiesce.rules.formats.files import FORMATS, read_rules, read_text
from quiesce.rules.model import (
    CENTROID,
    WEIGHTED_MAX,
    Condition,
    Rule,
)
from quiesce.rules.reference import evaluate
from rule_examples import reference_base
from rule_files import FCL, FIS, FLL, TANK, TEXTS, with_output

REFERENCE = {"singleton": WEIGHTED_MAX, "centroid": CENTROID}


# Reading


@pytest.mark.parametrize("kind", REFERENCE)
def test_reference_controller_is_the_published_one(kind: str) -> None:
    base = read_rules(ROOT / f"tools/benchmarks/rules/reference_{kind}.fcl")
    assert base == reference_base(REFERENCE[kind])
    assert base.notes == ()


@pytest.mark.parametrize("format", FORMATS)
def test_one_controller_in_each_format(format: str) -> None:
    assert read_text(TEXTS[format], format, "tank") == TANK


FCL_STYLES = {
    "lower case": FCL.lower(),
    "names in another case": FCL.replace("IF level IS low", "IF LEVEL IS Low"),
    "one line": " ".join(FCL.split()),
    "dense": re.sub(r" ?([:=;(),.]+) ?", r"\1", " ".join(FCL.split())),
    "windows line ends": FCL.replace("\n", "\r\n"),
    "old mac line ends": FCL.replace("\n", "\r"),
    "tabs and form feeds": FCL.replace("    ", "\t\f"),
    "comments": FCL.replace(";", "; (* a ; ** ) *) // ; (* { \n {pragma (*} /* x // */"),
    "comment first": "(* TERM x := 3; \n *)\n" + FCL,
    "numbers": FCL.replace("(8, 1)", "(.8e+1, 1.000)").replace("-2,", "-2.,"),
    "dots": FCL.replace("0 .. 10", "0..10").replace("-2 .. 2", "-2...2e1"),
    "accumulation of the rule block": FCL.replace("    ACCU : SUM;\n", "").replace(
        "    ACT", "    accu:sum;\n    ACT"
    ),
    "both accumulations": FCL.replace("    ACT", "    ACCU : SUM;\n    ACT"),
    "operators by default": re.sub(r"    (AND|OR|ACT) : \w+;\n", "", FCL),
    "parentheses": FCL.replace("level IS low AND", "((level IS low)) AND"),
    "NOT before": FCL.replace("flow IS NOT inward", "NOT flow IS inward"),
    "two NOTs": FCL.replace("flow IS NOT inward", "NOT NOT flow IS NOT inward"),
    "De Morgan": FCL.replace(
        "level IS high OR flow IS inward",
        "NOT (level IS NOT high AND NOT (flow IS inward))",
    ),
    "names of rules": FCL.replace("RULE 1 ", "RULE first"),
    "equal numbers of rules": FCL.replace("RULE 2 ", "RULE 1 "),
    "two rule blocks": FCL.replace("    RULE 2", "END_RULEBLOCK RULEBLOCK more\n  RULE 2"),
    "rule block without a name": FCL.replace("RULEBLOCK rules", "RULEBLOCK"),
    "list of variables": FCL.replace("level : REAL;\n    flow", "level, flow"),
    "no name": FCL.replace("FUNCTION_BLOCK tank", "FUNCTION_BLOCK"),
    "words for shapes": FCL.replace("(-1, 0) (0, 1) (1.5, 1) (2.5, 0)", "trape -1 0 1.5 2.5"),
    "rules first": re.sub(
        r"(VAR_INPUT.*?)(RULEBLOCK.*END_RULEBLOCK\n)", r"\2\1", FCL, flags=re.DOTALL
    ),
    "repeated point": FCL.replace("(0, 1) (5, 0)", "(0, 1) (0, 1) (5, 0)"),
}


@pytest.mark.parametrize("style", FCL_STYLES)
def test_fcl_style_makes_no_difference(style: str) -> None:
    text = FCL_STYLES[style]
    assert text != FCL
    assert read_text(text, "fcl", "tank") == TANK


FLL_STYLES = {
    "comments": FLL.replace("\n", "  # note: x\n# whole\n\n"),
    "no indent": re.sub("(?m)^ +", "", FLL),
    "deep indent": re.sub("(?m)^ +", "\t\t", FLL),
    "spaces": FLL.replace(": ", "  :   ").replace("  :   rules", ":rules"),
    "windows line ends": FLL.replace("\n", "\r\n"),
    "descriptions": FLL.replace("  enabled", '  description: any: "text" $ 1\n  enabled'),
    "no optional keys": re.sub(r"  (enabled|lock-\w+): \w+\n", "", FLL),
    "aggregation none": FLL.replace("UnboundedSum", "none"),
    "no aggregation": FLL.replace("  aggregation: UnboundedSum\n", ""),
    "defuzzifier of version 7": FLL.replace(" TakagiSugeno", " Automatic"),
    "defuzzifier alone": FLL.replace(" TakagiSugeno", ""),
    "implication": FLL.replace("implication: none", "implication: AlgebraicProduct"),
    "no name of the block": FLL.replace("RuleBlock: rules", "RuleBlock:"),
    "two blocks": FLL.replace(
        "  rule: if level is high", "RuleBlock: more\n  disjunction: Maximum\n"
        "  activation: General\n  rule: if level is high",
    ),
    "outputs first": re.sub(
        r"(InputVariable.*?)(OutputVariable.*?)(RuleBlock)", r"\2\1\3", FLL, flags=re.DOTALL
    ),
    "infinite shoulder": FLL.replace("Ramp 5.000 0.000", "Trapezoid -inf -inf 0.000 5.000"),
    "infinite shoulder to the right": FLL.replace("Ramp 2.000 8.000", "Trapezoid 2 8 inf inf"),
    "height": FLL.replace("Ramp 2.000 8.000", "Ramp 2.000 8.000 1.000"),
    "points": FLL.replace("Trapezoid -1.000 0.000 1.500 2.500", "Discrete -1 0 0 1 1.5 1 2.5 0"),
    "points with height": FLL.replace("Ramp 2.000 8.000", "Discrete 2 0 8 1 1"),
    "linear without slopes": FLL.replace("Constant 0.125", "Linear 0 0 0.125"),
    "parentheses": FLL.replace("level is high or", "(level is high) or"),
    "two nots": FLL.replace("is low", "is not not low"),
    "no rule needs it": FLL.replace("Maximum", "AlgebraicSum").replace(
        "level is high or flow is inward", "flow is inward"
    ),
}  # fmt: skip


@pytest.mark.parametrize("style", FLL_STYLES)
def test_fll_style_makes_no_difference(style: str) -> None:
    text = FLL_STYLES[style]
    assert text != FLL
    base = read_text(text, "fll", "tank")
    if style == "no rule needs it":
        base = replace(base, rules=(base.rules[0], TANK.rules[1]))
    assert base == TANK


FIS_STYLES = {
    "comments": FIS.replace("\n", "  % note '\n# whole [\n\n"),
    "spaces": re.sub("(?m)^([A-Za-z0-9]+)=", r"   \1  =  ", FIS).replace(":'", "  :  '"),
    "double quotes": FIS.replace("'", '"'),
    "windows line ends": FIS.replace("\n", "\r\n"),
    "commas": FIS.replace("[-1 0 1.5 2.5]", "[-1, 0,1.5 ,2.5]"),
    "bare constant": FIS.replace("[0.125]", "0.125"),
    "linear without slopes": FIS.replace("'constant',[0.125]", "'linear',[0 0 0.125]"),
    "no counts": re.sub(r"(?m)^Num.*\n", "", FIS),
    "decimal rules": FIS.replace("1 -2, 2 (0.75)", "1.000 -2.000 , 2.000 (0.750)"),
    "rules first": re.sub(r"(\[Input1\].*)(\[Rules\].*)", r"\2\n\1", FIS, flags=re.DOTALL),
    "outputs first": re.sub(
        r"(\[Input1\].*?)(\[Output1\].*?)(\[Rules\])", r"\2\1\3", FIS, flags=re.DOTALL
    ),
    "infinite shoulder": FIS.replace("'linzmf',[0 5]", "'trapmf',[-Inf -Inf 0 5]"),
    "infinite shoulder to the right": FIS.replace("'linsmf',[2 8]", "'trapmf',[2 8 inf Inf]"),
    "other implication": FIS.replace("ImpMethod='prod'", "ImpMethod='min'"),
    "no implication": FIS.replace("ImpMethod='prod'\n", ""),
    "no name": FIS.replace("Name='tank'", "Name=''"),
}


@pytest.mark.parametrize("style", FIS_STYLES)
def test_fis_style_makes_no_difference(style: str) -> None:
    text = FIS_STYLES[style]
    assert text != FIS
    assert read_text(text, "fis", "tank") == TANK


def test_byte_order_mark_is_no_character(tmp_path: Path) -> None:
    for format, text in TEXTS.items():
        file = tmp_path / f"tank.{format}"
        file.write_bytes(b"\xef\xbb\xbf" + text.encode())
        assert read_rules(file) == TANK


def test_fis_operator_that_no_rule_needs_may_be_any() -> None:
    text = FIS.replace("OrMethod='max'", "OrMethod='probor'").replace(
        "2 2, 1 (1) : 2", "0 2, 1 (1) : 2"
    )
    assert read_text(text, "fis", "tank").rules[1] == Rule((Condition(1, 1),), (0,))


def test_input_without_range_spans_its_points_and_says_so() -> None:
    base = read_text(FCL.replace("    RANGE := (0 .. 10);\n", ""), "fcl", "tank")
    assert (base.inputs[0].minimum, base.inputs[0].maximum) == (0.0, 8.0)
    assert len(base.notes) == 1 and "level" in base.notes[0] and "0 .. 8" in base.notes[0]


def test_fis_default_is_the_middle_of_the_range() -> None:
    base = read_text(FIS.replace("Range=[0 1]", "Range=[-1 1]"), "fis", "tank")
    assert base.outputs[0].default == 0.0
    assert "middle" in base.notes[0] and "valve" in base.notes[0]


def test_fll_default_nan_is_none() -> None:
    assert read_text(FLL.replace("0.500", "nan"), "fll", "tank").outputs[0].default is None
    assert read_text(FCL.replace("DEFAULT := 0.5;", ""), "fcl", "").outputs[0].default is None


def test_fll_height_scales_the_set() -> None:
    base = read_text(FLL.replace("0.000 1.500 2.500", "0.000 1.500 2.500 0.25"), "fll", "tank")
    assert base.inputs[1].sets[1].points == ((-1.0, 0.0), (0.0, 0.25), (1.5, 0.25), (2.5, 0.0))


def test_fll_aggregation_maximum_takes_the_greatest_strength() -> None:
    base = read_text(FLL.replace("UnboundedSum", "Maximum"), "fll", "tank")
    assert base == with_output(TANK, method=WEIGHTED_MAX)
    assert base == read_text(FCL.replace("ACCU : SUM", "ACCU : MAX"), "fcl", "tank")


# Mixed expressions


def mixed(expression: str) -> str:
    """FCL, greatest strength of a term, with one rule."""
    text = FCL.replace("ACCU : SUM", "ACCU : MAX")
    rule = f"RULE 1 : IF {expression} THEN valve IS open WITH 0.75;\n"
    return re.sub(r"(?s)RULE 1.*?(END_RULEBLOCK)", rule + r"\1", text)


LEVELS = ("level IS low", "level IS high", "flow IS outward", "flow IS inward")


@pytest.mark.parametrize(
    ("expression", "value"),
    [
        ("A AND B OR C", lambda a, b, c, d: max(min(a, b), c)),
        ("A OR B AND C", lambda a, b, c, d: max(a, min(b, c))),
        ("(A OR B) AND C", lambda a, b, c, d: min(max(a, b), c)),
        ("(A OR B) AND (C OR D)", lambda a, b, c, d: min(max(a, b), max(c, d))),
        ("NOT (A AND B) AND C", lambda a, b, c, d: min(1 - min(a, b), c)),
        ("NOT (A OR NOT (B AND C)) OR D", lambda a, b, c, d: max(1 - max(a, 1 - min(b, c)), d)),
        ("A AND NOT B AND (C OR D)", lambda a, b, c, d: min(a, 1 - b, max(c, d))),
    ],
)
def test_mixed_expression_becomes_rules_of_the_same_strength(expression: str, value) -> None:
    text = expression
    for letter, condition in zip("ABCD", LEVELS, strict=True):
        text = re.sub(rf"\b{letter}\b", condition, text)
    base = read_text(mixed(text), "fcl", "tank")
    assert len(base.rules) > 1
    grid = [g.ravel() for g in np.meshgrid(np.linspace(0, 10, 41), np.linspace(-2, 2, 41))]
    strengths = evaluate(base, grid, want_strengths=True).strengths.max(axis=0)
    sets = [(variable, one) for variable in (0, 1) for one in base.inputs[variable].sets]
    for point, found in enumerate(strengths):
        memberships = [one.membership(grid[variable][point]) for variable, one in sets]
        assert found == pytest.approx(0.75 * value(*memberships), abs=1e-12)


def test_mixed_expression_cannot_be_split_in_a_sum() -> None:
    text = FCL.replace("level IS high OR", "level IS high AND level IS low OR")
    with pytest.raises(UsageError, match=r"tank.fcl:32:17: AND and OR are mixed.*valve"):
        read_text(text, "fcl", "tank")
