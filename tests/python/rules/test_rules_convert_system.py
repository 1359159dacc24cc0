"""Systems of any kind written as FLL: what is read back answers the same."""

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
from quiesce.rules.system.model import BY_RULE, Conclusion, Proposition, StrengthTerm, System
from quiesce.rules.system.norms import HEDGES
from quiesce.rules.system.reference import evaluate
from system_examples import random_system

SYSTEMS = ROOT / "tests/unit/firmware/systems"
NUMBERS = range(25)
POINTS = 300


def read_back(system: System, folder: Path) -> System:
    file = folder / "written.fll"
    file.write_text(write_system(system, "fll"))
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
    assert "the default" in str(system_difference(system, changed_outputs(system, default=1.0)))
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


@pytest.mark.parametrize("format", ["fcl", "fis"])
def test_convert_says_which_format_holds_a_system(capsys, tmp_path: Path, format: str) -> None:
    out = tmp_path / f"again.{format}"
    command = ["rules", "convert", str(SYSTEMS / "gaussians.fll"), "--to", format]
    assert main([*command, "--out", str(out)]) == 2
    message = capsys.readouterr().err
    assert "gaussians.fll:29:16" in message and "or --to fll, which holds" in message
    assert len(message.splitlines()) == 1 and not out.exists()
