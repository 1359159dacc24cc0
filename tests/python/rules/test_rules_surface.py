"""Surfaces: what a running controller takes of rules that plain tables cannot hold. The firmware
against lines between values in float64, the error that is told, and what is refused."""

import subprocess
from pathlib import Path

import numpy as np
import pytest
from conftest import ROOT
from quiesce.base.errors import UsageError
from quiesce.cli.main import main
from quiesce.rules.controller import controller_table
from quiesce.rules.engine.engine import TableEngine
from quiesce.rules.formats.files import read_system
from quiesce.rules.integers.controller import INPUT_LSB, OUTPUT_LSB
from quiesce.rules.integers.rule_words import HEADER_WORDS
from quiesce.rules.surface.compile import Surface, compile_surface
from quiesce.rules.surface.place import Grid, best_values, hats, placed
from quiesce.rules.surface.words import NODE_WORDS, is_surface, read_surface, surface_words
from quiesce.rules.system.reference import evaluate
from quiesce.table.file import read_file
from quiesce.table.words import MOST_WORDS, crc_of

SEED = 20261128
GAUSSIANS = """[System]
Name='absorber'
Type='sugeno'
NumInputs=2
NumOutputs=1
NumRules=4
AndMethod='prod'
OrMethod='probor'
ImpMethod='prod'
AggMethod='sum'
DefuzzMethod='wtaver'
[Input1]
Name='freq'
Range=[0 25]
NumMFs=2
MF1='low':'gaussmf',[5 3]
MF2='high':'gaussmf',[5 18]
[Input2]
Name='acc'
Range=[0 10]
NumMFs=2
MF1='small':'gaussmf',[2 0]
MF2='big':'gaussmf',[3 10]
[Output1]
Name='current'
Range=[0 5]
NumMFs=3
MF1='off':'constant',[0]
MF2='half':'constant',[2.5]
MF3='full':'constant',[5]
[Rules]
1 1, 2 (1) : 1
1 2, 3 (1) : 1
2 1, 1 (1) : 1
2 2, 2 (1) : 1
"""
LINES = GAUSSIANS.replace("'half':'constant',[2.5]", "'half':'linear',[0.05 0.1 1]")
# The middle of what is highest jumps from one set to the other.
JUMPS = (
    GAUSSIANS.replace("Type='sugeno'", "Type='mamdani'")
    .replace("'prod'", "'min'")
    .replace("'probor'", "'max'")
    .replace("AggMethod='sum'", "AggMethod='max'")
    .replace("'wtaver'", "'mom'")
    .replace("'constant',[0]", "'trimf',[-1 0 1]")
    .replace("'constant',[2.5]", "'trimf',[1.5 2.5 3.5]")
    .replace("'constant',[5]", "'trimf',[4 5 6]")
)


def written(folder: Path, text: str) -> Path:
    file = folder / "absorber.fis"
    file.write_text(text)
    return file


def surface_of(file: Path) -> Surface:
    return compile_surface(read_system(file), INPUT_LSB, OUTPUT_LSB[0])


def bilinear(words: list[int], inputs: np.ndarray) -> np.ndarray:
    """From the numbers of the table, in float64. inputs: [2, point]."""
    table = read_surface(words)
    inside = [
        np.clip(x, nodes[0], nodes[-1]).astype(float)
        for x, nodes in zip(inputs, table.nodes, strict=True)
    ]
    down, across = (
        hats(x, np.array(nodes, dtype=float)) for x, nodes in zip(inside, table.nodes, strict=True)
    )
    return np.einsum("pr,rc,pc->p", down, table.counts, across)


@pytest.mark.parametrize("case", range(8))
def test_the_firmware_draws_straight_lines(case: int) -> None:
    """Within a count, and what two shares, Q15 and rounded down, are worth."""
    rng = np.random.default_rng([SEED, case])
    low, high = sorted(rng.integers(-(2**31), 2**31, 2).tolist())
    nodes = tuple(
        np.unique(np.concatenate([[low, high], rng.integers(low, high, rng.integers(1, 40))]))
        for _ in range(2)
    )
    span = float(rng.choice([3.0, 5000.0, 70_000.0, 1e8]))
    grid = Grid((nodes[0], nodes[1]), rng.uniform(-span, span, tuple(map(len, nodes))))
    words = surface_words(grid, False)
    points = rng.integers(-(2**31), 2**31, (2, 4000)).astype(np.int32)
    found, defaults = TableEngine(words).evaluate(list(points))
    assert not defaults.any()
    off = np.abs(found[0] - bilinear(words, points))
    assert off.max() <= 0.5 + 2.0 * (2.0 * span) * 2.0**-15
    # What was asked for is what stands in the table.
    assert np.abs(read_surface(words).counts - grid.values).max() <= 1.01 * span * 2.0**-15


def test_nodes_go_where_a_function_bends() -> None:
    """A kink along a line is held exactly, with few values; a smooth one takes the room."""
    x, y = np.linspace(0, 100, 101), np.linspace(0, 100, 101)
    kink = np.abs(x[:, None] - 37.0) + 0.5 * y[None, :]
    grid = placed((x, y), kink, 1000, NODE_WORDS, 256)
    assert [list(nodes) for nodes in grid.nodes] == [[0.0, 37.0, 100.0], [0.0, 100.0]]
    smooth = np.sin(x / 9.0)[:, None] * np.cos(y / 7.0)[None, :]
    errors = []
    for room in (100, 400, 1600):
        grid = placed((x, y), smooth, room, NODE_WORDS, 256)
        rows, columns = grid.values.shape
        assert NODE_WORDS * (rows + columns) + (rows * columns + 1) // 2 <= room
        down, across = hats(x, grid.nodes[0]), hats(y, grid.nodes[1])
        errors.append(np.abs(down @ grid.values @ across.T - smooth).max())
    assert errors[0] > 2.0 * errors[1] > 4.0 * errors[2]


def test_values_never_reach_beyond_the_samples() -> None:
    x = np.arange(41.0)
    step = np.where(x[:, None] < 20.0, 0.0, 5.0) * np.ones(41)[None, :]
    grid = best_values((x, x), step, ([0, 12, 28, 40], [0, 40]))
    assert grid.values.min() >= 0.0 and grid.values.max() <= 5.0


@pytest.mark.parametrize("text", [GAUSSIANS, LINES], ids=["constants", "lines"])
def test_smooth_rules_are_near_everywhere(tmp_path: Path, text: str) -> None:
    """At points that nobody looked at when it was made."""
    surface = surface_of(written(tmp_path, text))
    assert len(surface.words) <= MOST_WORDS and surface.error <= 1e-3
    rng = np.random.default_rng(SEED)
    system = surface.scaled.system
    counts = [
        surface.scaled.input_integer(i, rng.uniform(one.minimum, one.maximum, 20_000))
        for i, one in enumerate(system.inputs)
    ]
    found, _ = TableEngine(surface.words).evaluate(counts)
    x = [surface.scaled.input_value(i, one) for i, one in enumerate(counts)]
    off = np.abs(surface.scaled.output_value(0, found[0]) - evaluate(system, x).outputs[0])
    assert off.max() / 5.0 <= 1.5 * surface.error + 1e-4


@pytest.mark.parametrize("name", ["reference_product.fis", "reference_sugeno.fis"])
def test_products_of_straight_lines_need_few_values(name: str) -> None:
    surface = surface_of(ROOT / "tools/benchmarks/rules" / name)
    assert surface.error <= 2e-4 and max(surface.nodes) <= 12


def test_a_folder_stands_alone(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file, out = written(tmp_path, GAUSSIANS), tmp_path / "out"
    assert main(["rules", "compile", str(file), "--controller", "--out", str(out)]) == 0
    said = capsys.readouterr()
    assert "taken: the surface of its answers" in said.err and "error      0.0" in said.out
    sources = [*map(str, out.glob("*.c")), str(out / "demo/main.c")]
    flags = ("-std=c11", "-Wall", "-Wextra", "-Wpedantic", "-Werror")
    subprocess.run(["cc", *flags, *sources, "-o", str(out / "demo/run")], check=True)
    done = subprocess.run([out / "demo/run"], capture_output=True, text=True, check=True)
    assert done.stdout.splitlines()[-1].startswith("32 points, 0 values that differ")
    words = read_file(out / "absorber.table").words
    assert is_surface(words) and list(controller_table(file).words) == words
    assert main(["table", "show", str(out / "absorber.table")]) == 0
    assert "straight lines between; A over Hz (rows) and m/s2 (columns)" in capsys.readouterr().out


def test_rules_that_jump_are_refused_unless_asked_for(tmp_path: Path, capsys) -> None:
    file, out = written(tmp_path, JUMPS), tmp_path / "out"
    call = ["rules", "compile", str(file), "--controller", "--out", str(out)]
    assert main(call) == 2
    lines = capsys.readouterr().err.splitlines()
    assert len(lines) == 1 and "--max-error" in lines[0] and "freq" in lines[0]
    assert not out.exists()
    with pytest.raises(UsageError, match="jump or bend more than"):
        controller_table(file)
    assert main([*call, "--max-error", "100"]) == 0
    assert (out / "absorber.table").exists()


@pytest.mark.parametrize("inputs", [1, 3])
def test_other_shapes_are_refused(tmp_path: Path, inputs: int) -> None:
    third = GAUSSIANS.split("[Input2]")[1].split("[Output1]")[0]
    text = GAUSSIANS.replace("NumInputs=2", f"NumInputs={inputs}")
    if inputs == 3:
        more = "[Input3]" + third.replace("'acc'", "'heat'") + "[Output1]"
        text = text.replace("[Output1]", more)
        for rule in ("1 1,", "1 2,", "2 1,", "2 2,"):
            text = text.replace(f"\n{rule}", f"\n{rule[:-1]} 1,")
    else:
        text = text.replace("[Input2]" + third, "")
        for rule in ("1 1,", "1 2,", "2 1,", "2 2,"):
            text = text.replace(f"\n{rule}", f"\n{rule[0]},")
    with pytest.raises(UsageError, match=f"{inputs} inputs"):
        controller_table(written(tmp_path, text))


def test_damaged_words_are_told(tmp_path: Path) -> None:
    words = list(surface_of(ROOT / "tools/benchmarks/rules/reference_product.fis").words)
    for at, value in ((4, words[4] | 0xFF << 16), (9, len(words)), (9, HEADER_WORDS - 1)):
        broken = [*words[:at], value, *words[at + 1 :]]
        broken[1] = crc_of(broken[2:])
        with pytest.raises(ValueError, match="lies outside"):
            read_surface(broken)
        with pytest.raises(UsageError, match="the firmware refuses"):
            TableEngine(broken)
    with pytest.raises(ValueError, match="no surface"):
        read_surface(words[:-1])
