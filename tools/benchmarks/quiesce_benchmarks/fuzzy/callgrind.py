"""Host instructions of the engines and of libfuzzylite on the same inputs, under callgrind.

One evaluation's share: the program's total with EVALUATIONS evaluations less its total with none.
"""

import re
import subprocess
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from quiesce.base.errors import BenchFailure, UsageError
from quiesce.engine.bench import ending
from quiesce.rules.engine.engine import STRAIGHT, TABLE
from quiesce.rules.engine.native_build import build, firmware_sources
from quiesce.rules.formats.files import write_text
from quiesce.rules.integers.emit import straight_line_c
from quiesce.rules.integers.table import table_words

from quiesce_benchmarks.fuzzy.peers import COUNT, FUZZYLITE, built_peer
from quiesce_benchmarks.fuzzy.reference import (
    CENTROID,
    METHODS,
    Q15,
    SUM,
    Variant,
    compiled,
    reference_base,
)

EVALUATIONS = 1000
SEED = 12345
COLLECTED = re.compile(r"Collected : (\d+)")


@dataclass(frozen=True)
class HostCount:
    """Mean instructions of an evaluation."""

    what: str
    method: str
    mean_instr: float


def points_of(method: str) -> np.ndarray:
    """[point, input], even over the universes: a linear congruential generator's upper halves."""
    state = np.uint32(SEED)
    inputs = reference_base(method).inputs
    values = np.empty((EVALUATIONS, len(inputs)))
    with np.errstate(over="ignore"):
        for row in values:
            for i, variable in enumerate(inputs):
                state = state * np.uint32(1664525) + np.uint32(1013904223)
                share = float(state >> np.uint32(16)) / 65535
                row[i] = variable.minimum + share * (variable.maximum - variable.minimum)
    return values


def total_instr(command: Sequence[str | Path]) -> int:
    """Of the whole program."""
    valgrind = ["valgrind", "--tool=callgrind", "--callgrind-out-file=/dev/null"]
    try:
        done = subprocess.run(
            [*valgrind, *map(str, command)],
            stdin=subprocess.DEVNULL,
            capture_output=True,
            text=True,
        )
    except FileNotFoundError:
        raise UsageError("valgrind is not installed (Debian: apt-get install valgrind)")
    match = COLLECTED.search(done.stderr)
    if done.returncode != 0 or match is None:
        raise BenchFailure(f"valgrind {command[0]} ended with {ending(done.returncode)}")
    return int(match[1])


def mean_instr(command: Sequence[str | Path]) -> float:
    """command: without its last word, the number of evaluations."""
    many, none = (total_instr([*command, str(count)]) for count in (EVALUATIONS, 0))
    return (many - none) / EVALUATIONS


def engine_library(variant: Variant) -> Path:
    """Exports count_straight and count_table."""
    made = compiled(variant)
    words = ", ".join(f"{word}u" for word in table_words(made))
    declared = "".join(
        f"uint32_t count_{kind}(const int32_t *input, int32_t *output);\n"
        for kind in (STRAIGHT, TABLE)
    )
    text = (
        f'#include "fuzzy.h"\n{declared}{straight_line_c(made, f"count_{STRAIGHT}")}'
        f"static const uint32_t words[] = {{{words}}};\n"
        f"uint32_t count_{TABLE}(const int32_t *input, int32_t *output) {{\n"
        "    return fuzzy_evaluate((const fuzzy_table_t *)(const void *)words, input, output);\n}\n"
    )
    return build(firmware_sources(), {"count.c": text}, ())


def count_engines(folder: Path) -> list[HostCount]:
    program = built_peer(COUNT)
    found = []
    for method in METHODS:
        variant = Variant(method, Q15)
        made = compiled(variant)
        integers = [made.input_integer(i, x) for i, x in enumerate(points_of(method).T)]
        file = folder / f"{variant.name}.points"
        np.stack(integers, axis=1).astype(np.int32).tofile(file)
        library = engine_library(variant)
        for kind in (TABLE, STRAIGHT):
            command = [program, library, f"count_{kind}", file]
            found.append(HostCount(f"ours, {kind}", method, mean_instr(command)))
    return found


def count_fuzzylite(folder: Path, resolutions: Sequence[int]) -> list[HostCount]:
    """resolutions: 0 for the singletons, which it sums."""
    program = built_peer(FUZZYLITE)
    found = []
    for resolution in resolutions:
        method = CENTROID if resolution else SUM
        rules, file = folder / f"{method}.fll", folder / f"{method}.float"
        rules.write_text(write_text(reference_base(method), "fll"), encoding="utf-8")
        points_of(method).tofile(file)
        command = [program, rules, file, "/dev/null", str(resolution)]
        what = f"libfuzzylite 6, {resolution} samples" if resolution else "libfuzzylite 6"
        found.append(HostCount(what, method, mean_instr(command)))
    return found


def measure_host(resolutions: Sequence[int]) -> list[HostCount]:
    """UsageError where valgrind or libfuzzylite cannot be had."""
    with TemporaryDirectory() as name:
        return [*count_engines(Path(name)), *count_fuzzylite(Path(name), resolutions)]
