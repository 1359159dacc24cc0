"""A compiled system's integers beside float64: at every input integer where they are few, else at
random ones, at corners and around the worst that was found.

The firmware's engine is built with the undefined-behaviour sanitizer, which stops it where it
overflows or divides by zero.
"""

import subprocess
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from quiesce.base.errors import BenchFailure, one_line
from quiesce.rules.analysis.systems.sample import draw
from quiesce.rules.engine.native_build import SYSTEM_SOURCES, build, firmware_sources
from quiesce.rules.engine.system_engine import SOURCE as MANY_SYSTEM
from quiesce.rules.proof.walk import SANITIZE, OutputWalk
from quiesce.rules.system.compile import CompiledSystem
from quiesce.rules.system.model import SET_METHODS, VALUE_METHODS, System
from quiesce.rules.system.reference import WEAKEST, Answers, evaluate

SOURCE = Path(__file__).parent / "native/walk_system.c"
EVERY, EVERY_OF_SETS = 1 << 18, 1 << 16  # integers, all of which are walked
POINTS, POINTS_OF_SETS = 1 << 16, 1 << 13
QUICK = 8  # times fewer
CHUNK = 1 << 12
BESIDE = (-1, 0, 1)  # counts beside a corner
SEEDS, ROUNDS, REACH = 6, 8, (1, 8, 64)  # of the search around the worst: points, counts
MOST_OF_POINTS = 0.99
INT32 = (-(1 << 31), (1 << 31) - 1)
SEED = 3


@dataclass(frozen=True)
class SystemOutputWalk(OutputWalk):
    """weak: points where its rules fire, but none by WEAKEST; they are not judged, and their
    outputs reach from weak_least to weak_most. most_error: of MOST_OF_POINTS of the judged ones."""

    judged: int
    weak: int
    weak_least: float
    weak_most: float
    most_error: float


@dataclass(frozen=True)
class SystemWalk:
    is_complete: bool  # every integer within the universes
    points: int
    inside: int  # integers that there are within
    outputs: tuple[SystemOutputWalk, ...]


@dataclass(frozen=True)
class Answered:
    """counts: [input, point]; all else [output, point], in the output's unit."""

    counts: np.ndarray
    values: np.ndarray
    is_default: np.ndarray
    wanted: Answers

    def errors(self, index: int) -> np.ndarray:
        """-1 where it is not judged."""
        both = ~self.is_default[index] & ~self.wanted.is_default[index]
        judged = both & (self.wanted.strongest[index] >= WEAKEST)
        off = np.abs(self.values[index] - self.wanted.outputs[index])
        return np.where(judged, off, -1.0)


def walk_system(
    compiled: CompiledSystem,
    is_quick: bool = False,
    progress: Callable[[int, int], None] = lambda done, total: None,
) -> SystemWalk:
    """progress: called with points done and their total. BenchFailure where the sanitizer stops
    the engine."""
    program = build([*firmware_sources(SYSTEM_SOURCES), MANY_SYSTEM, SOURCE], {}, SANITIZE, "")
    counts, is_complete = counts_of(compiled, is_quick)
    parts = []
    for first in range(0, counts.shape[1], CHUNK):
        parts.append(answered(compiled, program, counts[:, first : first + CHUNK]))
        progress(min(first + CHUNK, counts.shape[1]), counts.shape[1])
    found = joined(parts)
    if not is_complete:
        found = searched(compiled, program, found)
    outputs = tuple(output_walk(compiled, i, found) for i in range(len(compiled.output_axes)))
    return SystemWalk(is_complete, found.counts.shape[1], integers(compiled), outputs)


# ---- points -------------------------------------------------------------------------------------


def limits(compiled: CompiledSystem) -> list[tuple[int, int]]:
    return [
        (int(compiled.input_integer(i, one.minimum)), int(compiled.input_integer(i, one.maximum)))
        for i, one in enumerate(compiled.system.inputs)
    ]


def integers(compiled: CompiledSystem) -> int:
    total = 1
    for low, high in limits(compiled):
        total *= high - low + 1
    return total


def has_sets(system: System) -> bool:
    return any(output.method in SET_METHODS for output in system.outputs)


def counts_of(compiled: CompiledSystem, is_quick: bool) -> tuple[np.ndarray, bool]:
    """[input, point], and whether they are all."""
    system = compiled.system
    every, points = (EVERY_OF_SETS, POINTS_OF_SETS) if has_sets(system) else (EVERY, POINTS)
    ends = np.array([[low] * 2 + [high] * 2 for low, high in limits(compiled)])
    ends[:, 0], ends[:, 3] = INT32
    if integers(compiled) <= every and not is_quick:
        axes = [np.arange(low, high + 1) for low, high in limits(compiled)]
        grid = np.array([one.ravel() for one in np.meshgrid(*axes, indexing="ij")])
        return np.concatenate([grid, ends], axis=1), True
    count = points // QUICK if is_quick else points
    x = draw(system, count, SEED)
    rng = np.random.default_rng(SEED)
    near = np.array([compiled.input_integer(i, one) for i, one in enumerate(x)]).astype(np.int64)
    near += rng.choice(BESIDE, near.shape)
    return np.concatenate([near, ends], axis=1), False


def searched(compiled: CompiledSystem, program: Path, found: Answered) -> Answered:
    """With points around those of the largest errors, from the best of each round on."""
    rng = np.random.default_rng(SEED)
    low, high = np.array(limits(compiled)).T[..., None]
    for _ in range(ROUNDS):
        seeds = np.concatenate(
            [
                np.argsort(-found.errors(i), kind="stable")[:SEEDS]
                for i in range(len(compiled.output_axes))
            ]
        )
        at = np.repeat(found.counts[:, seeds], 4 * len(REACH), axis=1)
        moved = at + rng.integers(-1, 2, at.shape) * rng.choice(REACH, at.shape)
        around = np.clip(moved, low, high)
        found = joined([found, answered(compiled, program, around)])
    return found


# ---- answers ------------------------------------------------------------------------------------


def answered(compiled: CompiledSystem, program: Path, counts: np.ndarray) -> Answered:
    out, defaults = run(compiled, program, counts)
    count = len(compiled.output_axes)
    values = np.array([compiled.output_value(i, out[i]) for i in range(count)])
    is_default = np.array([(defaults >> i & 1) > 0 for i in range(count)])
    x = [compiled.input_value(i, one) for i, one in enumerate(counts)]
    return Answered(counts, values, is_default, evaluate(compiled.system, x))


def run(
    compiled: CompiledSystem, program: Path, counts: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """[output, point] integers, and the masks of defaults."""
    points, outputs = counts.shape[1], len(compiled.output_axes)
    words = np.array([len(compiled.words), *compiled.words, points], dtype=np.uint32)
    process = subprocess.run(
        [program], input=words.tobytes() + counts.astype(np.int32).tobytes(), capture_output=True
    )
    if process.returncode != 0:
        complaint = process.stderr.decode(errors="replace")
        raise BenchFailure(f"the walk stopped: {one_line(complaint)[:300]}")
    found = np.frombuffer(process.stdout, dtype=np.int32)
    split = points * outputs
    return found[:split].reshape(outputs, points), found[split:].view(np.uint32)


def joined(parts: list[Answered]) -> Answered:
    def all_of(*arrays: np.ndarray) -> np.ndarray:
        return np.concatenate(arrays, axis=-1)

    wanted = Answers(
        all_of(*(part.wanted.outputs for part in parts)),
        all_of(*(part.wanted.is_default for part in parts)),
        all_of(*(part.wanted.strongest for part in parts)),
    )
    return Answered(
        all_of(*(part.counts for part in parts)),
        all_of(*(part.values for part in parts)),
        all_of(*(part.is_default for part in parts)),
        wanted,
    )


def output_walk(compiled: CompiledSystem, index: int, found: Answered) -> SystemOutputWalk:
    errors = found.errors(index)
    worst = int(np.argmax(errors))
    judged = errors >= 0.0
    strong = found.wanted.strongest[index] >= WEAKEST
    is_default, wanted_default = found.is_default[index], found.wanted.is_default[index]
    # A formula of an output that has no value, and no default, is no number in float64.
    has_values = compiled.system.outputs[index].method in VALUE_METHODS
    no_number = wanted_default & (found.wanted.strongest[index] > 0.0) & has_values
    differs = (is_default != wanted_default) & strong & ~no_number
    is_weak = ~wanted_default & ~strong
    least, most = ends_of(found.values[index][~is_default & ~is_weak])
    weak_least, weak_most = ends_of(found.values[index][~is_default & is_weak])

    def units(point: int) -> tuple[float, ...]:
        return tuple(
            float(compiled.input_value(i, n)) for i, n in enumerate(found.counts[:, point])
        )

    return SystemOutputWalk(
        name=compiled.system.outputs[index].name,
        unit_error=float(errors[worst]),
        value=float(found.values[index, worst]),
        reference=float(found.wanted.outputs[index, worst]),
        at=units(worst),
        least=least,
        most=most,
        defaults=int(is_default.sum()),
        default_differs=int(differs.sum()),
        differs_at=units(int(np.argmax(differs)) if differs.any() else worst),
        judged=int(judged.sum()),
        weak=int(is_weak.sum()),
        weak_least=weak_least,
        weak_most=weak_most,
        most_error=float(np.quantile(errors[judged], MOST_OF_POINTS)) if judged.any() else 0.0,
    )


def ends_of(values: np.ndarray) -> tuple[float, float]:
    """NaN of none."""
    return (float(values.min()), float(values.max())) if values.size else (np.nan, np.nan)
