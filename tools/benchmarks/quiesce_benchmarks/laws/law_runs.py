"""Runs laws by the program of this machine and by its image: tools/benchmarks/laws."""

import subprocess
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np
from quiesce.base.errors import BenchFailure, UsageError, one_line
from quiesce.base.paths import build_folder
from quiesce.compare.laws import constant
from quiesce.compare.roads import road
from quiesce.compare.run import Case, Shaking
from quiesce.engine.bench import Bench, require_emulator, require_file
from quiesce.engine.board import Board, load_board
from quiesce.engine.params import effective_params

from quiesce_benchmarks.controller.rigs import FULL_SCALE, NO_SAMPLE, random_counts
from quiesce_benchmarks.images import built_image
from quiesce_benchmarks.laws import rigs
from quiesce_benchmarks.laws.law_cases import LawCase

WHOLE, ALONE, SPOIL = range(3)  # modes of an order
BLOCK_TICKS = 64
IMAGE = "law_runs"


@dataclass(frozen=True)
class Run:
    """blocks: CRC-32 of the outputs of so many ticks each. worst, mean: instructions, of an image
    only."""

    printed: dict[str, int]
    blocks: tuple[int, ...]
    worst: int = 0
    mean: float = 0.0

    def __getitem__(self, name: str) -> int:
        return self.printed[name]


def order(case: LawCase, mode: int, ticks: int, seed: int, counts: np.ndarray | None) -> bytes:
    """As law_order.h has it. counts [ticks sensors] int32, for WHOLE."""
    head = [mode, ticks, seed, BLOCK_TICKS, len(case.words), len(case.map_words)]
    settings = [f"law={case.law}", *([f"tracker={case.tracker}"] if case.tracker else [])]
    params = list(effective_params(Bench(), settings).values())
    words = [*head, *params, *board_words(case.rig), *case.words, *case.map_words]
    tail = b"" if counts is None else np.ascontiguousarray(counts, "<i4").tobytes()
    return np.array([int(one) & 0xFFFFFFFF for one in words], "<u4").tobytes() + tail


@cache
def board_words(rig: str) -> tuple[int, ...]:
    return tuple(Bench().json("board-check", str(rigs.files(rig)[1]))["words"])


@cache
def board_of(rig: str) -> Board:
    return load_board(Bench(), rigs.files(rig)[1])


@cache
def recorded_counts(rig: str, ticks: int, seed: int) -> np.ndarray:
    """[ticks sensors]: what the rig's sensors say on a rough road, with half of the current."""
    on = rigs.comparison(rig, Shaking(scale_to_m_s2=3.0))
    names = [f"{one.name}_counts" for one in board_of(rig).sensors]
    law = constant(on.rig.all_mA // 2, "half")
    trace = on.trace(Case(law, road("C", 72.0, seed), seed), names)
    counts = np.stack([trace[name] for name in names], axis=1).astype(np.int32)
    return np.resize(counts, (ticks, len(names)))


@cache
def counts_of(rig: str, ticks: int, seed: int) -> np.ndarray:
    """[ticks sensors]: half of it as recorded, half of it tones, noise, steps, lost samples."""
    recorded = recorded_counts(rig, ticks // 2, seed)
    limits = np.array([one.full_scale_counts for one in board_of(rig).sensors])
    rng = np.random.default_rng([seed, len(limits)])
    made_up = random_counts(rng, len(limits), ticks - len(recorded))
    scaled = (made_up.astype(np.int64) * limits // FULL_SCALE).astype(np.int32)
    return np.vstack([recorded, np.where(made_up == NO_SAMPLE, NO_SAMPLE, scaled)])


def on_host(words: bytes) -> Run:
    """BenchFailure where the program dies, UsageError where it refuses the order."""
    built_image(IMAGE)  # with it the program
    program = require_file(build_folder() / "host/tools/benchmarks" / IMAGE, "the program")
    with tempfile.NamedTemporaryFile(prefix="quiesce-laws-") as file:
        file.write(words)
        file.flush()
        done = subprocess.run([program, file.name], capture_output=True, text=True)
    if done.returncode == 1:
        raise UsageError(one_line(done.stderr))
    if done.returncode != 0:
        raise BenchFailure(f"{IMAGE} ended with {done.returncode}: {one_line(done.stderr)}")
    lines = (line.split() for line in done.stdout.splitlines())
    return _run({name: int(value, 16) for name, value in lines})


def on_image(words: bytes) -> Run:
    require_emulator()
    with tempfile.NamedTemporaryFile(prefix="quiesce-laws-") as file:
        file.write(words)
        file.flush()
        found = Bench().json("count", "--image", str(built_image(IMAGE)), "--data", file.name)
    return _run(found["printed"], found["worst"], found["mean"])


def _run(printed: dict[str, int], worst: int = 0, mean: float = 0.0) -> Run:
    blocks = sorted(name for name in printed if name.startswith("block"))
    others = {name: value for name, value in printed.items() if name not in blocks}
    return Run(others, tuple(printed[name] for name in blocks), worst, mean)


def words_apart(ours: Run, theirs: Run, ticks: int) -> int:
    """Words of all blocks whose CRC-32 differ."""
    differing = sum(a != b for a, b in zip(ours.blocks, theirs.blocks, strict=True))
    return min(differing * BLOCK_TICKS, ticks) * ours["words_a_tick"]


def largest(runs: Sequence[Run], name: str) -> int:
    return max(run[name] for run in runs)
