"""Every input integer of a rule base through the firmware's engines, beside an exact reference.

native/walk.c does the work, built with the undefined-behaviour sanitizer: it stops where an engine
overflows or divides by zero.
"""

import json
import os
import subprocess
import threading
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from quiesce.base.errors import BenchFailure, one_line
from quiesce.rules.engine.native_build import build, firmware_sources
from quiesce.rules.integers.compiled import CompiledBase
from quiesce.rules.proof.walk_model import grid_points, integer_range, model_text

SOURCE = Path(__file__).parent / "native/walk.c"
MAX_WALKED_POINTS = 1 << 32
SANITIZE = ("-fsanitize=undefined", "-fno-sanitize-recover=undefined", "-Wno-unused-function")
CHUNKS_A_JOB = 16


@dataclass(frozen=True)
class OutputWalk:
    name: str
    unit_error: float  # worst |engine - reference|, in the output's unit; -1: no point had a value
    value: float  # there
    reference: float
    at: tuple[float, ...]  # inputs there, in their units
    least: float  # of all values, in the output's unit
    most: float
    defaults: int  # points where no rule fires
    default_differs: int  # points where only one of the two has the default
    differs_at: tuple[float, ...]


@dataclass(frozen=True)
class Walk:
    is_complete: bool  # every integer inside the universes, else every cell, sampled
    points: int
    engines_differ: int  # points where straight-line C is not the table's number; -1: there is none
    outputs: tuple[OutputWalk, ...]


def build_walk(compiled: CompiledBase) -> Path:
    texts = {"model_values.h": model_text(compiled)}
    return build([*firmware_sources(), SOURCE], texts, SANITIZE, "")


def walk(
    compiled: CompiledBase,
    jobs: int = 0,
    max_points: int = MAX_WALKED_POINTS,
    progress: Callable[[int, int], None] = lambda done, total: None,
) -> Walk:
    """All integers where they are at most max_points, and in any case every cell, sampled.

    progress: called with points done and their total, from several threads. BenchFailure where the
    sanitizer stops the walk.
    """
    program = build_walk(compiled)
    found = [run(program, ["samples"], lambda done: None)]
    total = grid_points(compiled)
    is_complete = total <= max_points
    if is_complete:
        found += walk_all(compiled, program, jobs or os.cpu_count() or 1, total, progress)
    return merged(compiled, found, is_complete)


def walk_all(
    compiled: CompiledBase,
    program: Path,
    jobs: int,
    total: int,
    progress: Callable[[int, int], None],
) -> list[dict[str, Any]]:
    first, last = integer_range(compiled, 0)
    count = last - first + 1
    chunks = min(count, jobs * CHUNKS_A_JOB)
    ends = [first + count * k // chunks for k in range(chunks + 1)]
    done = [0] * chunks
    lock = threading.Lock()

    def one(k: int) -> dict[str, Any]:
        def report(points: int) -> None:
            with lock:
                done[k] = points
                progress(sum(done), total)

        return run(program, [str(ends[k]), str(ends[k + 1])], report)

    with ThreadPoolExecutor(jobs) as pool:
        return list(pool.map(one, range(chunks)))


def run(program: Path, words: Sequence[str], report: Callable[[int], None]) -> dict[str, Any]:
    process = subprocess.Popen(
        [program, *words], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    assert process.stdout is not None and process.stderr is not None
    complaint = ""
    try:
        for line in process.stderr:
            if line.strip().isdigit():
                report(int(line))
            else:
                complaint += line
        text = process.stdout.read()
    except BaseException:
        process.kill()
        raise
    finally:
        process.wait()
    if process.returncode != 0:
        raise BenchFailure(f"the walk stopped: {one_line(complaint)[:300]}")
    return json.loads(text)


def merged(compiled: CompiledBase, found: Sequence[dict[str, Any]], is_complete: bool) -> Walk:
    has_straight = "#define MODEL_STRAIGHT" in model_text(compiled)
    outputs = tuple(
        merged_output(compiled, index, [part["outputs"][index] for part in found])
        for index in range(len(compiled.outputs))
    )
    differ = sum(part["engines_differ"] for part in found) if has_straight else -1
    return Walk(is_complete, sum(part["points"] for part in found), differ, outputs)


def merged_output(
    compiled: CompiledBase, index: int, parts: Sequence[dict[str, Any]]
) -> OutputWalk:
    worst = max(parts, key=lambda part: part["worst"])
    differing = next((part for part in parts if part["default_differs"]), worst)

    def units(integers: Sequence[int]) -> tuple[float, ...]:
        return tuple(float(compiled.input_value(i, n)) for i, n in enumerate(integers))

    def value(integer: int) -> float:
        return float(compiled.output_value(index, integer))

    return OutputWalk(
        name=compiled.base.outputs[index].name,
        unit_error=worst["worst"],
        value=worst["value"],
        reference=worst["reference"],
        at=units(worst["at"]),
        least=value(min(part["least"] for part in parts)),
        most=value(max(part["most"] for part in parts)),
        defaults=sum(part["defaults"] for part in parts),
        default_differs=sum(part["default_differs"] for part in parts),
        differs_at=units(differing["differs_at"]),
    )
