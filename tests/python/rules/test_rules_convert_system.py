"""Systems of any kind written in each format: what is read back answers the same."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from conftest import ROOT
from quiesce.base.errors import UsageError
from quiesce.cli.main import main
from quiesce.rules.analysis.systems.sample import draw
from quiesce.rules.formats.files import read_system, write_system
from quiesce.rules.formats.same_system import system_difference
from quiesce.rules.formats.shapes import FCL_SHAPES, FIS_SHAPES, FLL_SHAPES
from quiesce.rules.formats.write_system_fll import WORDS
from quiesce.rules.model import AND, OR
from quiesce.rules.system.model import (
    BY_RULE,
    BY_TERM,
    CENTROID,
    SMALLEST,
    Complement,
    Conclusion,
    Join,
    Proposition,
    StrengthTerm,
    System,
)
from quiesce.rules.system.norms import HEDGES
from quiesce.rules.system.reference import evaluate
from system_examples import random_system

SYSTEMS = ROOT / "tests/unit/firmware/systems"
NUMBERS = range(25)
POINTS = 300
HEDGED = ((), ("not",), ("very",), ("not", "somewhat"), ("cubed",))  # as FIS has them


def read_back(system: System, folder: Path, format: str = "fll") -> System:
    file = folder / f"written.{format}"
    file.write_text(write_system(system, format))
    return read_system(file)


def apart(one: System, other: System) -> float:
    """The largest difference of answers, of a range, at points that the writer did not look at."""
    x = list(draw(one, POINTS, seed=99))
    first, second = (evaluate(system, x) for system in (one, other))
    assert np.array_equal(first.is_default, second.is_default)
    spans = np.array([[output.maximum - output.minimum] for output in one.outputs])
    off = np.abs(np.nan_to_num(first.outputs) - np.nan_to_num(second.outputs)) / spans
    return float(off.max())


@pytest.mark.parametrize("name", ["eight", "gaussians", "norms", "variables"])
def test_systems_of_the_firmware_s_tests(tmp_path: Path, name: str) -> None:
    system = read_system(SYSTEMS / f"{name}.fll")
    again = read_back(system, tmp_path)
    assert apart(system, again) < 1e-12
    assert write_system(again, "fll") == write_system(system, "fll")


def test_other_formats(tmp_path: Path) -> None:
    fcl = read_system(SYSTEMS / "maxima.fcl")
    assert apart(fcl, read_back(fcl, tmp_path)) < 1e-12
    text = (SYSTEMS / "tsukamoto.fis").read_text()
    (tmp_path / "t.fis").write_text(text.replace("'as it moves'", "'moving'"))
    fis = read_system(tmp_path / "t.fis")
    again = read_back(fis, tmp_path)
    assert apart(fis, again) < 1e-12
    terms = [term for output in again.outputs for term in output.terms]
    assert any(isinstance(term, StrengthTerm) and term.is_inverse for term in terms)


@pytest.mark.parametrize("number", NUMBERS)
def test_random_systems_are_read_back(tmp_path: Path, number: int) -> None:
    words = [hedge for hedge in HEDGES if hedge != "cubed"]
    system = random_system(number, any_norm=True, hedge_words=words)
    assert apart(system, read_back(system, tmp_path)) < 1e-9


@pytest.mark.parametrize("number", NUMBERS)
def test_random_systems_in_fcl(tmp_path: Path, number: int) -> None:
    words = [hedge for hedge in HEDGES if hedge != "cubed"]
    system = random_system(number, any_norm=True, hedge_words=words)
    outputs = tuple(
        replace(one, clips=False, places=1000 if one.places else 0) for one in system.outputs
    )
    system = replace(system, name="random", outputs=outputs)
    assert apart(system, read_back(system, tmp_path, "fcl")) < 1e-9


def rows_only(system: System) -> System:
    """As much of a system as FIS holds: one output, one block, conditions without parentheses."""
    rng = np.random.default_rng(8)
    output = replace(system.outputs[0], clips=False, default=None)
    is_set = output.places > 0
    middle = 0.5 * (output.minimum + output.maximum)
    method = CENTROID if is_set else BY_RULE
    output = replace(output, places=1000 if is_set else 0, default=middle, method=method)
    rules = []
    for rule in system.rules:
        parts = tuple(
            Proposition(True, i, int(rng.integers(len(one.terms))), HEDGED[int(rng.integers(5))])
            for i, one in enumerate(system.inputs)
        )
        expression = parts[0] if len(parts) == 1 else Join(str(rng.choice([AND, OR])), parts)
        rules.append(
            replace(rule, block=0, expression=expression, conclusions=rule.conclusions[:1])
        )
    blocks = system.blocks[:1]
    return System(system.name, system.inputs, (output,), blocks, tuple(rules))


@pytest.mark.parametrize("number", NUMBERS)
def test_random_rows_in_fis(tmp_path: Path, number: int) -> None:
    system = rows_only(random_system(number, any_norm=True))
    again = read_back(system, tmp_path, "fis")
    assert apart(system, again) < 1e-9
    assert [rule.expression for rule in again.rules] == [rule.expression for rule in system.rules]


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"expression": Complement(Proposition(True, 0, 0))}, "no parentheses"),
        ({"expression": Proposition(False, 0, 0)}, "no conditions on outputs"),
        ({"expression": Join(AND, (Proposition(True, 0, 0), Proposition(True, 0, 1)))}, "twice"),
        ({"expression": Proposition(True, 0, 0, ("seldom",))}, "no hedges 'seldom'"),
        ({"expression": Proposition(True, 0, 0, ("very", "not"))}, "no hedges 'very not'"),
        ({"block": 1}, "one block of rules"),
    ],
)
def test_what_fis_cannot_hold_of_rules(changes: dict, words: str) -> None:
    system = rows_only(random_system(3))
    blocks = (system.blocks[0], replace(system.blocks[0], conjunction="DrasticProduct"))
    used = blocks if "block" in changes else system.blocks
    rules = (replace(system.rules[0], **changes), *system.rules[1:])
    with pytest.raises(UsageError, match=words):
        write_system(replace(system, blocks=used, rules=rules), "fis")


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"default": 0.1}, "FIS has no default"),
        ({"method": BY_TERM}, "its Sugeno systems add up the rules"),
        ({"clips": True}, "does not limit a weighted value"),
        ({"method": SMALLEST, "places": 1000}, "som and lom of FIS are by magnitude"),
        ({"method": CENTROID, "places": 100}, "FIS has no resolution"),
    ],
)
def test_what_fis_cannot_hold_of_outputs(changes: dict, words: str) -> None:
    (number, *_) = (k for k in NUMBERS if random_system(k).outputs[0].places == 0)
    system = rows_only(random_system(number))
    system = replace(system, rules=(replace(system.rules[0], weight=0.0),))
    with pytest.raises(UsageError, match=words):
        write_system(changed_outputs(system, **changes), "fis")


def test_every_smooth_shape_has_its_word() -> None:
    for shapes in (FLL_SHAPES, FIS_SHAPES, FCL_SHAPES):
        assert all(shape.make in WORDS for shape in shapes.values() if shape.is_smooth)


def test_parameters_stand_in_the_file_s_order() -> None:
    for shape in (*FLL_SHAPES.values(), *FIS_SHAPES.values(), *FCL_SHAPES.values()):
        values = [float(k) for k in range(shape.parameters)]
        assert shape.as_in_file(shape.ordered(values)) == values


# ---- what would be lost --------------------------------------------------------------------------


def changed_outputs(system: System, **changes: object) -> System:
    first, *rest = system.outputs
    return replace(system, outputs=(replace(first, **changes), *rest))


def test_differences_are_told() -> None:
    system = read_system(SYSTEMS / "gaussians.fll")
    assert system_difference(system, system) is None
    lighter = (replace(system.rules[0], weight=0.99), *system.rules[1:])
    assert "answers of output I" in str(system_difference(system, replace(system, rules=lighter)))
    assert system_difference(system, changed_outputs(system, name="J")) == "names of variables"
    assert system_difference(system, changed_outputs(system, maximum=11.0)) == "the range of I"
    # A default that no input reaches may be any.
    assert system_difference(system, changed_outputs(system, default=1.0)) is None
    silent = replace(system, rules=(replace(system.rules[0], weight=0.0),))
    assert system_difference(silent, changed_outputs(silent, default=1.0)) is not None
    fewer = system.outputs[0].terms[:-1]
    assert system_difference(system, changed_outputs(system, terms=fewer)) == "the terms of I"


def test_conclusions_with_hedges_of_their_own_become_rules() -> None:
    system = read_system(SYSTEMS / "norms.fll")
    hedged = replace(system.rules[0], conclusions=(Conclusion(0, 0, ("very",)), Conclusion(1, 0)))
    text = write_system(replace(system, rules=(hedged, *system.rules[1:])), "fll")
    first = text[text.index("  rule: ") :].splitlines()[:2]
    assert " then u is very " in first[0] and " and v is " not in first[0].split(" then ")[1]
    assert " then v is " in first[1]
    named = replace(hedged, expression=Proposition(False, 0, 0))
    with pytest.raises(UsageError, match="rule 1: FLL has no hedges of single conclusions"):
        write_system(replace(system, rules=(named, *system.rules[1:])), "fll")


def test_what_fll_cannot_hold_is_named() -> None:
    system = read_system(SYSTEMS / "gaussians.fll")
    cubed = replace(system.rules[0], expression=Proposition(True, 0, 0, ("cubed",)))
    with pytest.raises(UsageError, match="rule 1: FLL has no hedge 'cubed'"):
        write_system(replace(system, rules=(cubed,)), "fll")
    condition = replace(system.rules[0], expression=Proposition(False, 0, 0))
    averaged = changed_outputs(system, method=BY_RULE, aggregation="Maximum")
    with pytest.raises(UsageError, match="no average rule by rule with aggregation Maximum"):
        write_system(replace(averaged, rules=(*system.rules, condition)), "fll")
    with pytest.raises(UsageError, match="FLL names have letters"):
        write_system(changed_outputs(system, name="two words"), "fll")


# ---- the command ---------------------------------------------------------------------------------


def test_convert_writes_a_system(capsys, tmp_path: Path) -> None:
    out = tmp_path / "again.fll"
    command = ["rules", "convert", str(SYSTEMS / "maxima.fcl"), "--to", "fll"]
    assert main([*command, "--out", str(out)]) == 0
    assert "keeps its last value" in capsys.readouterr().err
    assert system_difference(read_system(SYSTEMS / "maxima.fcl"), read_system(out)) is None
    assert main(command) == 0
    assert capsys.readouterr().out == out.read_text()


@pytest.mark.parametrize(
    ("name", "format", "words"),
    [
        ("eight", "fcl", "output total: FCL does not limit a weighted value to the range"),
        ("norms", "fcl", "output u: FCL has no resolution; 1000 places, and here 60"),
        ("norms", "fis", "FIS has one method and one aggregation for all outputs"),
        ("variables", "fis", "FIS has one method and one aggregation for all outputs"),
    ],
)
def test_what_a_format_cannot_hold_is_one_line(
    capsys, tmp_path: Path, name: str, format: str, words: str
) -> None:
    out = tmp_path / f"again.{format}"
    command = ["rules", "convert", str(SYSTEMS / f"{name}.fll"), "--to", format]
    assert main([*command, "--out", str(out)]) == 2
    message = capsys.readouterr().err
    assert words in message and len(message.splitlines()) == 1 and not out.exists()
