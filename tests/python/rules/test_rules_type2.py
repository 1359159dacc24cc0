"""Files of interval type-2 sets: Nie and Tan's answers, and what else they ask for."""

import itertools
import re
from pathlib import Path

import numpy as np
import pytest
from quiesce.base.errors import UsageError
from quiesce.cli.main import main
from quiesce.rules.engine.precise import compile_precisely
from quiesce.rules.formats.build import NotPlain
from quiesce.rules.formats.files import read_rules, read_system, write_system
from quiesce.rules.system.karnik_mendel import karnik_mendel, nie_tan
from quiesce.rules.system.reference import evaluate

TEXT = """[System]
Name='fan'
Type='sugeno'
Version=2.0
NumInputs=2
NumOutputs=1
NumRules=4
AndMethod='prod'
OrMethod='probor'
ImpMethod='prod'
AggMethod='sum'
DefuzzMethod='wtaver'
TypeRedMethod='NT'
outputType='interval'

[Input1]
Name='heat'
Range=[-1 1]
NumMFs=2
MF1U='coolU':'trimf',[-3 -1 1 1]
MF1L='coolL':'trimf',[-2.5 -1 0.5 0.6]
MF2U='hotU':'trimf',[-1 1 3 1]
MF2L='hotL':'trimf',[-0.5 1 2.5 0.8]

[Input2]
Name='rate'
Range=[0 10]
NumMFs=2
MF1U='slow':'gaussmf',[4 0 1]
MF1L='slow':'gaussmf',[3 0 0.5]
MF2U='fast':'gaussmf',[4 10 1]
MF2L='fast':'gaussmf',[2 10 0.9]

[Output1]
Name='speed'
CrispInterval='interval'
Range=[0 5]
NumMFs=3
MF1='low':'constant',[0.5 1.5]
MF2='high':'constant',4
MF3='line':'linear',[0.5 0.1 2 1.5 0.3 2.5]

[Rules]
1 1, 1 (1) : 1
1 2, 3 (1) : 1
2 1, 2 (0.5) : 1
2 2, 3 (1) : 1
"""
Edit = tuple[str, str]


def written(folder: Path, *edits: Edit) -> Path:
    text = TEXT
    for old, new in edits:
        assert old in text
        text = text.replace(old, new)
    file = folder / "fan.t2fis"
    file.write_text(text)
    return file


def grid() -> tuple[np.ndarray, np.ndarray]:
    heat, rate = np.meshgrid(np.linspace(-1, 1, 41), np.linspace(0, 10, 37))
    return heat.ravel(), rate.ravel()


def triangle(x: np.ndarray, a: float, b: float, c: float, height: float) -> np.ndarray:
    return height * np.clip(np.minimum((x - a) / (b - a), (c - x) / (c - b)), 0, None)


def bell(x: np.ndarray, deviation: float, mean: float, height: float) -> np.ndarray:
    return height * np.exp(-((x - mean) ** 2) / (2 * deviation**2))


def memberships(heat: np.ndarray, rate: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """[set, end, point] of each input, the upper end first: of the numbers in TEXT."""
    of_heat = [
        [triangle(heat, -3, -1, 1, 1), triangle(heat, -2.5, -1, 0.5, 0.6)],
        [triangle(heat, -1, 1, 3, 1), triangle(heat, -0.5, 1, 2.5, 0.8)],
    ]
    of_rate = [
        [bell(rate, 4, 0, 1), bell(rate, 3, 0, 0.5)],
        [bell(rate, 4, 10, 1), bell(rate, 2, 10, 0.9)],
    ]
    return np.array(of_heat), np.array(of_rate)


def average(strengths: np.ndarray, heat: np.ndarray, rate: np.ndarray) -> np.ndarray:
    """strengths: [rule, end, point] of the four rules."""
    line = 1.0 * heat + 0.2 * rate + 2.25
    values = np.array([np.full_like(heat, 1.0), line, np.full_like(heat, 4.0), line])
    both = strengths.sum(axis=1)
    return (both * values).sum(axis=0) / both.sum(axis=0)


def test_answers_are_those_of_nie_and_tan(tmp_path: Path) -> None:
    heat, rate = grid()
    a, b = memberships(heat, rate)
    strengths = np.array([a[0] * b[0], a[0] * b[1], 0.5 * a[1] * b[0], a[1] * b[1]])
    answers = evaluate(read_system(written(tmp_path)), [heat, rate])
    assert np.abs(answers.outputs[0] - average(strengths, heat, rate)).max() < 1e-12


def test_not_takes_the_other_end(tmp_path: Path) -> None:
    file = written(tmp_path, ("1 1, 1 (1) : 1", "-1 1, 1 (1) : 1"))
    heat, rate = grid()
    a, b = memberships(heat, rate)
    negated = (1 - a[0])[::-1]
    strengths = np.array([negated * b[0], a[0] * b[1], 0.5 * a[1] * b[0], a[1] * b[1]])
    system = read_system(file)
    answers = evaluate(system, [heat, rate])
    assert np.abs(answers.outputs[0] - average(strengths, heat, rate)).max() < 1e-12
    assert any("divides by those of a negated term" in note for note in system.notes)


def test_or_takes_the_same_ends(tmp_path: Path) -> None:
    file = written(tmp_path, ("1 1, 1 (1) : 1", "1 1, 1 (1) : 2"))
    heat, rate = grid()
    a, b = memberships(heat, rate)
    either = a[0] + b[0] - a[0] * b[0]
    strengths = np.array([either, a[0] * b[1], 0.5 * a[1] * b[0], a[1] * b[1]])
    answers = evaluate(read_system(file), [heat, rate])
    assert np.abs(answers.outputs[0] - average(strengths, heat, rate)).max() < 1e-12


def test_sets_without_width_are_those_of_type_1(tmp_path: Path) -> None:
    file = written(
        tmp_path, ("[-2.5 -1 0.5 0.6]", "[-3 -1 1 1]"), ("[-0.5 1 2.5 0.8]", "[-1 1 3 1]"),
        ("[3 0 0.5]", "[4 0 1]"), ("[2 10 0.9]", "[4 10 1]"),
    )  # fmt: skip
    text = re.sub(r"(?m)^MF\dL.*\n|^TypeRed.*\n|^outputType.*\n|^Crisp.*\n", "", file.read_text())
    text = re.sub(r"(MF\d)U=(.*mf',\[.*) 1\]", r"\1=\2]", text)
    text = text.replace("[0.5 1.5]", "[1]").replace("[0.5 0.1 2 1.5 0.3 2.5]", "[1 0.2 2.25]")
    (tmp_path / "one.fis").write_text(text)
    one, two = read_system(tmp_path / "one.fis"), read_system(file)
    points = list(grid())
    assert np.allclose(evaluate(one, points).outputs, evaluate(two, points).outputs, atol=1e-12)


def test_integers_answer_like_float64(tmp_path: Path) -> None:
    precise = compile_precisely(read_system(written(tmp_path)))
    assert precise.error < 1e-3
    assert 4 * len(precise.compiled.words) <= 8192


def test_a_system_of_type_1_answers_the_same(tmp_path: Path) -> None:
    system = read_system(written(tmp_path))
    (tmp_path / "one.fll").write_text(write_system(system, "fll"))
    again = read_system(tmp_path / "one.fll")
    points = list(grid())
    apart = evaluate(system, points).outputs - evaluate(again, points).outputs
    assert np.abs(apart).max() < 1e-12
    with pytest.raises(UsageError, match="FIS has no gaussmf of another height than 1"):
        write_system(system, "fis")


def test_equal_names_of_a_pair_are_told_apart(tmp_path: Path) -> None:
    names = [term.name for term in read_system(written(tmp_path)).inputs[1].terms]
    assert names == ["slowU", "slowL", "fastU", "fastL"]


def test_a_running_controller_takes_them(capsys, tmp_path: Path) -> None:
    file = written(
        tmp_path, ("heat", "frequency"), ("Range=[-1 1]", "Range=[2 30]"),
        ("[-3 -1 1 1]", "[-20 2 24 1]"), ("[-2.5 -1 0.5 0.6]", "[-18 2 20 0.8]"),
        ("[-1 1 3 1]", "[2 30 50 1]"), ("[-0.5 1 2.5 0.8]", "[6 30 48 0.8]"),
        ("rate", "acceleration"), ("speed", "current"), ("[0.5 0.1 2 1.5 0.3 2.5]", "[0 0.1 2]"),
    )  # fmt: skip
    out = tmp_path / "made"
    assert main(["rules", "compile", str(file), "--controller", "--out", str(out)]) == 0
    assert (out / "fan.table").is_file()
    assert "taken: the surface of its answers" in capsys.readouterr().err


def test_karnik_and_mendel_s_answers_are_the_extremes_of_all_strengths() -> None:
    rng = np.random.default_rng(5)
    lower = rng.uniform(0, 1, (5, 40))
    strengths = np.array([lower, lower + rng.uniform(0, 1, lower.shape)])
    values = np.sort(rng.uniform(-1, 1, (2, 5, 40)), axis=0)
    ends = []
    for value, choose in ((values[0], np.min), (values[1], np.max)):
        averages = []
        for picked in itertools.product((0, 1), repeat=5):
            taken = strengths[list(picked), range(5)]
            averages.append((taken * value).sum(axis=0) / taken.sum(axis=0))
        ends.append(choose(averages, axis=0))
    assert np.abs(karnik_mendel(strengths, values) - np.mean(ends, axis=0)).max() < 1e-12
    assert np.isnan(karnik_mendel(np.zeros((2, 5, 1)), values[:, :, :1])).all()
    assert np.isnan(nie_tan(np.zeros((2, 5, 1)), values[:, :, :1])).all()


@pytest.mark.parametrize(
    "edit", [("'NT'", "'Karnik-Mendel'"), ("'NT'", "'EIASC'"), ("TypeRedMethod='NT'\n", "")]
)
def test_other_reductions_are_refused_with_their_distance(tmp_path: Path, edit: Edit) -> None:
    with pytest.raises(UsageError) as caught:
        read_system(written(tmp_path, edit))
    found = re.search(r"at most ([0-9.]+) % of the range", str(caught.value))
    assert found and "write TypeRedMethod='NT'" in str(caught.value)
    assert 0.1 < float(found[1]) < 20


def test_sets_without_width_have_no_distance(tmp_path: Path) -> None:
    file = written(
        tmp_path, ("'NT'", "'KM'"), ("[-2.5 -1 0.5 0.6]", "[-3 -1 1 1]"),
        ("[-0.5 1 2.5 0.8]", "[-1 1 3 1]"), ("[3 0 0.5]", "[4 0 1]"), ("[2 10 0.9]", "[4 10 1]"),
        ("[0.5 1.5]", "[1 1]"), ("[0.5 0.1 2 1.5 0.3 2.5]", "[1 0.2 2.25]"),
    )  # fmt: skip
    with pytest.raises(UsageError) as caught:
        read_system(file)
    found = re.search(r"at most (\S+) % of the range", str(caught.value))
    assert found and float(found[1]) < 1e-10


def test_a_lower_set_above_its_upper_one_is_told(tmp_path: Path) -> None:
    system = read_system(written(tmp_path, ("[3 0 0.5]", "[5 0 1]")))
    (note,) = [note for note in system.notes if "above" in note]
    assert "input rate: the lower set slowL is above its upper one by" in note


def test_what_the_toolbox_does_otherwise_is_told(tmp_path: Path) -> None:
    notes = read_system(written(tmp_path, ("AndMethod='prod'", "AndMethod='min'"))).notes
    assert any(note.startswith("AND, weights: computed as the file says") for note in notes)


def test_a_plain_base_cannot_hold_them(tmp_path: Path) -> None:
    with pytest.raises(NotPlain, match="sets of type 2"):
        read_rules(written(tmp_path))


FAULTS: list[tuple[Edit, str]] = [
    (("Type='sugeno'", "Type=@'mamdani'"), "Type 'mamdani' of a type-2 file, expected 'sugeno'"),
    (("'NT'", "@'BMM(0.5,0.5)'"), "TypeRedMethod 'BMM(0.5,0.5)', expected 'NT'"),
    (("'NT'", "@1"), "found '1', expected text in quotes"),
    (("'wtaver'", "@'wtsum'"), "DefuzzMethod 'wtsum', expected 'wtaver'"),
    (("MF1L='coolL'", "@MF3L='coolL'"), "found 'MF3L', expected 'MF1L'"),
    (("MF1L='coolL':'trimf',[-2.5 -1 0.5 0.6]\n", ""), "found 'MF2U', expected 'MF1L'"),
    (("MF2L='hotL':'trimf',[-0.5 1 2.5 0.8]\n", ""), "'MF2U' alone, expected 'MF2L' behind it"),
    (("MF1U='coolU'", "@MF1='coolU'"), "found 'MF1', expected 'MF1U'"),
    (("[-3 -1 1 1]", "[-3 -1 1@]"), "found ']', expected 4 numbers"),
    (("'trimf',[-3 -1 1 1]", "@'trimf',[-3 -1 1 1.5]"), "height 1.5 of trimf"),
    (("'trimf',[-3 -1 1 1]", "@'trimf',[-3 -1 1 0]"), "height 0 of trimf"),
    (("'trimf',[-3 -1 1 1]", "@'trimf',[-1 -3 1 1]"), "expected parameters that never fall"),
    (("'trimf',[-3 -1 1 1]", "@'trifm',[-3 -1 1 1]"), "membership function 'trifm'"),
    (("'gaussmf',[4 0 1]", "@'gaussmf',[0 0 1]"), "a standard deviation above 0"),
    (("'constant',[0.5 1.5]", "@'constant',[0.5 1 1.5]"), "3 numbers of constant, expected 1"),
    (("'linear',[0.5 0.1 2 1.5", "@'linear',[0.5 0.1 2 1.5 7"), "7 numbers of linear, expected 3"),
    (("'constant',4", "@'trimf',[1 2 3]"), "membership function 'trimf', expected constant or"),
    (("1 1, 1 (1) : 1", "@3 1, 1 (1) : 1"), "no term 3 of input heat, expected 0 to 2"),
    (("NumMFs=2\nMF1U='cool", "NumMFs=@4\nMF1U='cool"), "NumMFs is 4, there are 2"),
    (("CrispInterval='interval'", "CrispInterval=@1"), "expected 'crisp' or 'interval'"),
    (("Name='speed'", "Name='speed'\n@Default=0"), "no key 'Default' here"),
]


@pytest.mark.parametrize(("edit", "words"), FAULTS)
def test_faults_are_one_line(capsys, tmp_path: Path, edit: Edit, words: str) -> None:
    old, new = edit
    file = written(tmp_path, (old, new.replace("@", "")))
    assert main(["rules", "convert", str(file), "--to", "fll"]) == 2
    said = capsys.readouterr().err
    assert words in said and said.count("\n") == 1
    if "@" in new:
        text = TEXT.replace(old, new)
        before = text[: text.index("@", text.index(new))]
        place = f"{before.count(chr(10)) + 1}:{len(before) - before.rfind(chr(10))}: "
        assert f"fan.t2fis:{place}" in said


def mutant(rng: np.random.Generator) -> str:
    """Another digit, or a piece taken out, doubled or put somewhere else."""
    text = TEXT
    digits = [at for at, one in enumerate(text) if one.isdigit()]
    if rng.random() < 0.5:
        at = int(rng.choice(digits))
        return text[:at] + str(rng.integers(10)) + text[at + 1 :]
    a, b, at = (int(one) for one in rng.integers(0, len(text), 3))
    end = min(len(text), a + b % 12 + 1)
    cut = text[:a] + text[end:]
    return (cut, text[:end] + text[a:], cut[:at] + text[a:end] + cut[at:])[rng.integers(3)]


def test_mutants_are_read_or_refused_with_their_place(tmp_path: Path) -> None:
    rng = np.random.default_rng(11)
    file, ends = tmp_path / "fan.t2fis", {"read": 0, "refused": 0}
    for _ in range(1500):
        file.write_text(mutant(rng))
        try:
            read_system(file)
            ends["read"] += 1
        except UsageError as error:
            assert re.match(r".*fan\.t2fis:\d+:\d+: .", str(error)), error
            ends["refused"] += 1
    assert min(ends.values()) > 100


def test_no_format_is_written_that_only_is_read(capsys, tmp_path: Path) -> None:
    assert main(["rules", "convert", str(written(tmp_path)), "--to", "t2fis"]) == 2
    assert "invalid choice: 't2fis'" in capsys.readouterr().err
