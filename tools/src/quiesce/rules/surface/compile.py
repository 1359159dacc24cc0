"""A fuzzy system of two inputs and one output as a surface that a controller can take, and how far
that is from what the system says."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from fractions import Fraction

import numpy as np

from quiesce.base.errors import UsageError
from quiesce.rules.analysis.systems.support import corners
from quiesce.rules.engine.engine import TableEngine
from quiesce.rules.engine.precise import compile_precisely
from quiesce.rules.engine.system_engine import SystemEngine
from quiesce.rules.integers.rule_words import HEADER_WORDS
from quiesce.rules.surface.place import Grid, placed
from quiesce.rules.surface.words import MOST_NODES, NODE_WORDS, surface_words
from quiesce.rules.system.compile import CompiledSystem, ScaledSystem
from quiesce.rules.system.model import System
from quiesce.rules.system.reference import WEAKEST, evaluate
from quiesce.table.words import MOST_WORDS

LINES = 193  # of an input that are looked at, beside its corners
FINER = 64  # counts of the samples to one of the output
POINTS = 4000
SEED = 1


@dataclass(frozen=True)
class Surface:
    """error: the greatest over the output's range, at POINTS random counts of the inputs where some
    rule fires by WEAKEST or none does; worst_at: where, in the file's units."""

    scaled: ScaledSystem
    grid: Grid
    words: tuple[int, ...]
    error: float
    worst_at: tuple[float, ...]

    @property
    def nodes(self) -> tuple[int, int]:
        rows, columns = self.grid.values.shape
        return rows, columns


def compile_surface(
    system: System,
    inputs: tuple[float, float],
    output: float,
    defaults: Mapping[str, float] | None = None,
    is_for_controller: bool = True,
) -> Surface:
    """inputs, output: what one count is. UsageError where the system has another shape."""
    if (len(system.inputs), len(system.outputs)) != (2, 1):
        raise UsageError(
            f"{system.name} has {len(system.inputs)} inputs and {len(system.outputs)} outputs; a "
            "surface has two inputs and one output"
        )
    fine = compile_precisely(system, list(inputs), [output / FINER], defaults).compiled
    assert isinstance(fine, CompiledSystem)
    lines = (lines_of(fine, 0), lines_of(fine, 1))
    room = MOST_WORDS - HEADER_WORDS
    grid = placed(lines, samples_of(fine, lines) / FINER, room, NODE_WORDS, MOST_NODES)
    return judged(system, fine, output, grid, surface_words(grid, is_for_controller))


def lines_of(compiled: ScaledSystem, index: int) -> np.ndarray:
    """Counts, evenly over the universe; of each corner the counts beside it, too."""
    variable = compiled.system.inputs[index]
    even = np.linspace(variable.minimum, variable.maximum, LINES)
    bends = compiled.input_integer(index, np.array(corners(variable))).astype(np.int64)
    beside = np.concatenate([bends - 1, bends, bends + 1])
    ends = compiled.input_integer(index, np.array([variable.minimum, variable.maximum]))
    every = np.union1d(compiled.input_integer(index, even), beside)
    return every[(every >= ends[0]) & (every <= ends[1])]


def samples_of(compiled: CompiledSystem, lines: tuple[np.ndarray, np.ndarray]) -> np.ndarray:
    rows, columns = np.meshgrid(*lines, indexing="ij")
    out, _ = SystemEngine(compiled).evaluate([rows.ravel(), columns.ravel()])
    return out[0].reshape(rows.shape).astype(float)


def judged(
    system: System, compiled: CompiledSystem, lsb: float, grid: Grid, words: list[int]
) -> Surface:
    """lsb: what a count of the output is."""
    rng = np.random.default_rng(SEED)
    counts = [
        compiled.input_integer(i, rng.uniform(one.minimum, one.maximum, POINTS))
        for i, one in enumerate(system.inputs)
    ]
    x = [compiled.input_value(i, one) for i, one in enumerate(counts)]
    wanted = evaluate(system, x)
    right = np.where(wanted.is_default[0], compiled.defaults[0], wanted.outputs[0])
    is_clear = wanted.is_default[0] | (wanted.strongest[0] >= WEAKEST)
    found, _ = TableEngine(words).evaluate(counts)
    off = np.where(is_clear, np.abs(found[0] * lsb - right), 0.0)
    worst = int(off.argmax())
    output = system.outputs[0]
    return Surface(
        replace(compiled, output_axes=(replace(compiled.output_axes[0], lsb=Fraction(str(lsb))),)),
        grid,
        tuple(words),
        float(off[worst]) / (output.maximum - output.minimum),
        tuple(float(one[worst]) for one in x),
    )
