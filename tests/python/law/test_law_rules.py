"""Rule files of a user's as tables of law fuzzy_signals: what they mean, beside arithmetic that is
written another way, what is refused, and the bench with one."""

import json
from pathlib import Path

import numpy as np
import pytest
from conftest import ROOT
from quiesce.base.errors import UsageError
from quiesce.engine.bench import Bench
from quiesce.law.forms.fuzzy_signals import FuzzySignalsTable
from quiesce.law.from_rules import read_source, sources_of, table_of_rules
from quiesce.law.rig import LawRig, load_rig
from quiesce.law.tables import table_of_words
from quiesce.rules.formats.files import read_text
from quiesce.rules.integers.rule_words import read_rules
from quiesce.table.file import read_words
from quiesce_benchmarks.laws.firmware_laws import demands, verdict

BOARDS = ROOT / "sim_hil/data/boards"
BOARD = BOARDS / "three_storeys_1996.toml"

FIS = """[System]
Name='lines'
Type='sugeno'
AndMethod='min'
OrMethod='max'
DefuzzMethod='wtaver'

[Input1]
Name='vel'
Range=[-300 300]
MF1='N':'trapmf',[-900 -600 -300 300]
MF2='P':'trapmf',[-300 300 600 900]

[Input2]
Name='stroke_velocity'
Range=[-0.5 0.5]
MF1='N':'trapmf',[-2 -1 -0.5 0.5]
MF2='P':'trapmf',[-0.5 0.5 1 2]

[Output1]
Name='current'
Range=[0 2]
MF1='up':'linear',[0.002 1.5 0.25]
MF2='down':'linear',[-0.002 -1.5 0.25]
MF3='some':'constant',[0.1]

[Rules]
1 1, 2 (1) : 1
2 2, 1 (1) : 1
1 2, 3 (1) : 1
2 1, 3 (0.5) : 1
"""

FCL = """FUNCTION_BLOCK sets
VAR_INPUT
    drift : REAL; speed : REAL; force : REAL;
END_VAR
VAR_OUTPUT
    share : REAL;
END_VAR
FUZZIFY drift
    TERM S := (0, 1) (10, 0);
    TERM B := (0, 0) (10, 1);
    RANGE := (0 .. 10);
END_FUZZIFY
FUZZIFY speed
    TERM N := (-1, 1) (0, 0);
    TERM Z := (-1, 0) (0, 1) (1, 0);
    TERM P := (0, 0) (1, 1);
    RANGE := (-1 .. 1);
END_FUZZIFY
FUZZIFY force
    TERM N := (-1000, 1) (1000, 0);
    TERM P := (-1000, 0) (1000, 1);
    RANGE := (-1000 .. 1000);
END_FUZZIFY
DEFUZZIFY share
    TERM OFF := (0, 1) (0.6, 0);
    TERM ON := (0.4, 0) (1, 1);
    METHOD : COG;
    ACCU : MAX;
    DEFAULT := 0;
    RANGE := (0 .. 1);
END_DEFUZZIFY
RULEBLOCK all
    AND : MIN;
    ACT : MIN;
    RULE 1 : IF drift IS B AND speed IS NOT Z THEN share IS ON;
    RULE 2 : IF speed IS P AND force IS P THEN share IS ON;
    RULE 3 : IF drift IS S AND speed IS Z THEN share IS OFF;
    RULE 4 : IF speed IS N AND force IS P THEN share IS OFF;
END_RULEBLOCK
END_FUNCTION_BLOCK
"""


@pytest.fixture(scope="module")
def rig(build: Path) -> LawRig:
    return load_rig(Bench(), BOARD, None, 1000)


@pytest.fixture(scope="module")
def two(build: Path) -> LawRig:
    return load_rig(Bench(), BOARDS / "two_storeys.toml", None, 1000)


def table_of(rig: LawRig, text: str, kind: str, maps: list[str], A: float) -> FuzzySignalsTable:
    base = read_text(text, kind, "mine", first_order=True)
    return table_of_rules(rig, base, sources_of(rig, base, maps), A)


def motion(columns: int) -> np.ndarray:
    """Within 1, beyond it now and then."""
    rng = np.random.default_rng(4)
    t = np.arange(8000)[:, None] / 1000.0
    tones = sum(
        rng.uniform(0.3, 0.6, columns) * np.sin(2 * np.pi * rng.uniform(0.3, 20, columns) * t + k)
        for k in range(3)
    )
    return tones + 0.01 * rng.standard_normal((len(t), columns))


def worst(table: FuzzySignalsTable, values: np.ndarray, exact: np.ndarray) -> float:
    return float(np.abs(demands(table, values)[:, 0] - exact).max() / np.ptp(exact))


def test_lines_of_first_order_are_sugeno_s(rig: LawRig) -> None:
    """Weights and lines in numpy, from the file's text: mm/s of the third floor."""
    table = table_of(rig, FIS, "fis", ["vel=1000 velocity of third"], 1.0)
    assert [one.name for one in table.signals()] == [
        "velocity of body 3",
        "stroke velocity of damper 1",
    ]
    values = motion(2) * [0.3, 0.5]
    x = np.clip(values * [1000.0, 1.0], [-300.0, -0.5], [300.0, 0.5])
    p = np.clip((x + [300.0, 0.5]) / [600.0, 1.0], 0, 1)
    n = 1 - p
    weights = [
        np.minimum(n[:, 0], n[:, 1]),
        np.minimum(p[:, 0], p[:, 1]),
        np.minimum(n[:, 0], p[:, 1]),
        0.5 * np.minimum(p[:, 0], n[:, 1]),
    ]
    up = x @ [0.002, 1.5] + 0.25
    lines = [0.5 - up, up, np.full(len(x), 0.1), np.full(len(x), 0.1)]
    exact = sum(w * one for w, one in zip(weights, lines, strict=True)) / sum(weights)
    exact = np.clip(exact, 0.0, 20.0)
    assert np.ptp(exact) > 0.8
    assert table.currents_A(values)[:, 0] == pytest.approx(exact, abs=1e-9)
    assert worst(table, values, exact) < 0.002


def test_sets_of_three_signals_follow_the_reference(rig: LawRig) -> None:
    maps = ["drift=1000 |stroke|", "speed=stroke velocity"]
    table = table_of(rig, FCL, "fcl", maps, 2.0)
    values = motion(3) * [0.01, 1.0, 1000.0]
    exact = table.currents_A(values)[:, 0]
    assert np.ptp(exact) > 1.0
    assert worst(table, values, exact) < 0.002
    flipped = values * [-1.0, 1.0, 1.0]
    assert (demands(table, flipped) == demands(table, values)).all()


def test_words_come_back_and_rules_are_said_once(rig: LawRig, two: LawRig) -> None:
    text = FIS.replace("stroke_velocity", "stroke")
    one = table_of(two, text, "fis", ["vel=stroke velocity"], 1.0)
    assert len(two.dampers) == 2 and [s.at for s in one.signals()] == [0, 0, 1, 1]
    words = one.words()
    assert verdict(one.law, words) == 0
    again = table_of_words(words)
    assert again == one and again.words() == words
    rules = len(one.sections[0].rules.words)
    assert rules < len(words) < 2 * rules
    with pytest.raises(ValueError, match="no real numbers"):
        again.currents_A(np.zeros((1, 4)))


def test_body_signals_are_of_the_damper_s_own_end(two: LawRig) -> None:
    text = FIS.replace("stroke_velocity", "acceleration")
    table = table_of(two, text, "fis", ["vel=acceleration of roof"], 1.0)
    own = [damper.a for damper in two.dampers]
    assert [one.at for one in table.signals()] == [1, own[0], 1, own[1]] and own == [0, 1]
    assert read_source(two, " 2.5e2 |stroke of lower| ").factor == 250.0


SOURCES = [
    ("speed", "no quantity 'speed'; there are: acceleration"),
    ("|velocity", "expected [FACTOR] QUANTITY"),
    ("velocity of roof", "velocity of 'roof'; there are: first, second, third"),
    ("0 velocity", "a factor in 1e-9 .. 1e9, found '0'"),
    ("1e5e velocity", "a factor in 1e-9 .. 1e9, found '1e5e'"),
    ("-1 velocity", "a factor in 1e-9 .. 1e9"),
    ("", "expected [FACTOR] QUANTITY"),
]


@pytest.mark.parametrize(("text", "message"), SOURCES)
def test_what_is_no_signal_is_told(rig: LawRig, text: str, message: str) -> None:
    base = read_text(FIS, "fis", "mine", first_order=True)
    with pytest.raises(UsageError) as error:
        sources_of(rig, base, [f"vel={text}"])
    assert message in str(error.value) and "say --map 'vel=SIGNAL'" in str(error.value)
    assert "\n" not in str(error.value)


CHANGES = [
    (FIS, "fis", ["--map", "speed=velocity"], "expected NAME=SIGNAL of an input: vel"),
    (FIS, "fis", ["--map", "vel"], "expected NAME=SIGNAL of an input: vel"),
    (FIS, "fis", [], "input vel: no quantity 'vel'"),
    (FIS, "fis", ["--map", "vel=velocity", "--output-A", "0"], "1e+06, found '0'"),
    (FIS, "fis", ["--map", "vel=velocity", "--output-A", "nan"], "1e+06, found 'nan'"),
    (FIS, "fis", ["--map", "vel=velocity", "--output-A", "1000"], "output current spans 150 A"),
    (FIS, "fis", ["--map", "vel=displacement"], "does not fit int32"),
    (FIS.replace("wtaver", "wtsum"), "fis", [], "mine.fis:6:14"),
    (FIS.replace("'linear',[0.002 1.5 0.25]", "'linear',[0.002 0.25]"), "fis", [], "mine.fis"),
    (FIS.replace("0.002 1.5", "1e9 1.5"), "fis", ["--map", "vel=velocity"], "too steep"),
    ("nothing", "fis", [], "mine.fis:1:1"),
    (FIS, "txt", [], "not a rule file"),
    (FCL, "fcl", ["--map", "drift=temperature", "--map", "speed=velocity"], "has no temperature"),
]


@pytest.mark.parametrize(("text", "kind", "options", "message"), CHANGES)
def test_bad_files_are_one_line(
    quiesce, tmp_path: Path, text: str, kind: str, options: list[str], message: str
) -> None:
    file, out = tmp_path / f"mine.{kind}", tmp_path / "x.table"
    file.write_text(text)
    result = quiesce("law", "rules", file, "--board", BOARD, *options, "-o", out)
    assert result.returncode == 2
    assert message in result.stderr
    assert result.stderr.count("\n") == 1 and result.stderr.startswith("quiesce: ")
    assert not out.exists()


def test_slopes_over_four_inputs_and_two_outputs_are_refused(rig: LawRig) -> None:
    base = read_text(FIS, "fis", "mine", first_order=True)
    sources = sources_of(rig, base, ["vel=velocity"])
    twice = FIS.replace(
        "[Rules]", "[Output2]\nName='b'\nRange=[0 1]\nMF1='c':'constant',[1]\n[Rules]"
    )
    for number in ("1", "2", "3"):
        twice = twice.replace(f", {number} (", f", {number} 1 (")
    with pytest.raises(UsageError, match="has outputs current, b; a law takes rules of one"):
        table_of_rules(rig, read_text(twice, "fis", "mine", first_order=True), sources, 1.0)
    inputs = "".join(
        f"[Input{i}]\nName='{name}'\nRange=[0 1]\nMF1='L':'trimf',[-1 0 1]\n"
        for i, name in enumerate(("velocity", "displacement", "stroke", "force"), start=1)
    )
    four = (
        FIS[: FIS.index("[Input1]")]
        + inputs
        + (
            "[Output1]\nName='o'\nRange=[0 1]\nMF1='a':'linear',[1 1 1 1 0]\n"
            "[Rules]\n1 0 0 0, 1 (1) : 1\n"
        )
    )
    base = read_text(four, "fis", "mine", first_order=True)
    with pytest.raises(UsageError, match="slopes over 4 inputs; at most 3"):
        table_of_rules(rig, base, sources_of(rig, base, []), 1.0)


def test_rules_in_words_are_checked() -> None:
    with pytest.raises(ValueError, match="no table of rules"):
        read_rules([1, 2, 3])
    words = [0x31545A46, 0, 16, *[0] * 13]
    with pytest.raises(ValueError, match="CRC-32 of its rules"):
        read_rules(words)


def test_a_file_of_ones_own_runs_and_is_compared(quiesce, tmp_path: Path) -> None:
    rules, table = tmp_path / "mine.fis", tmp_path / "mine.table"
    rules.write_text(FIS)
    options = ["--board", BOARD, "--map", "vel=1000 velocity of third", "-o", table]
    made = json.loads(quiesce("law", "rules", rules, *options, "--json").stdout)
    assert made["law"] == "fuzzy_signals" and made["rules"] == 4
    assert made["notes"] and made["words"] == len(read_words(table))
    text = quiesce("law", "rules", rules, *options).stdout
    assert text.startswith("lines: ") and "--law fuzzy_signals --law-table" in text
    shown = " ".join(quiesce("table", "show", table).stdout.split())
    assert "0.25 A +2 A per m/s of 1 +1.5 A per m/s of 2" in shown and "weight 0.5" in shown
    t = np.arange(0, 2, 0.01)
    quake = tmp_path / "quake.csv"
    quake.write_text("t_s,acc_g\n" + "".join(f"{x:.2f},{0.2 * np.sin(20 * x):.5f}\n" for x in t))
    result = quiesce(
        "compare", "--rig", "three_storeys_1996", "--record", quake, "--accel-column", "acc_g",
        "--law", f"fuzzy_signals:table={table},as=mine", "--json",
    )  # fmt: skip
    assert result.returncode == 0, result.stderr
    cells = {one["law"]: one["figures"] for one in json.loads(result.stdout)["cells"]}
    assert 0.0 < cells["mine"]["current_mean_A"] < cells["all current"]["current_mean_A"]
    assert cells["mine"]["disp_rms_mm"] < cells["no current"]["disp_rms_mm"]
