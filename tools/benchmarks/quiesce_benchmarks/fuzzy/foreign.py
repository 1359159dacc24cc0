"""Rule files of other projects: how many compile, how large, how exact.

The yardstick of an FLL file is pyfuzzylite; it reads no other format, so that of FCL and FIS files
is our own float64 reference. Points where no rule fires by WEAKEST are not judged.
"""

import os
import tomllib
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np
from quiesce.base.errors import BenchFailure, UsageError, one_line
from quiesce.base.paths import build_folder, root, shown
from quiesce.base.progress import Progress
from quiesce.base.table import format_table
from quiesce.rules.engine.precise import WEAKEST, Precise, compile_precisely
from quiesce.rules.engine.system_engine import SystemEngine
from quiesce.rules.formats.files import read_system
from quiesce.rules.formats.shapes import gaussian
from quiesce.rules.model import AND
from quiesce.rules.system.model import (
    BY_RULE,
    Block,
    Conclusion,
    ConstantTerm,
    Curve,
    Join,
    Proposition,
    SetTerm,
    System,
    SystemInput,
    SystemOutput,
    SystemRule,
)
from quiesce.rules.system.norms import UNBOUNDED_SUM
from quiesce.rules.system.reference import evaluate

from quiesce_benchmarks.fuzzy.peers import Answer, Job, pyfuzzylite
from quiesce_benchmarks.images import build

LIST = "tools/benchmarks/rules/foreign.toml"
MOST_BYTES = 8192
MOST_ERROR_PCT = 1.0  # as `rules compile` takes without being told
POINTS = 500
SEED = 7
WORD_BYTES = 4


@dataclass(frozen=True)
class Tried:
    """One file. bytes: 0 where it is refused. error_pct: of an output's range, the largest."""

    name: str
    bytes: int
    error_pct: float | None
    against: str
    refused: str

    @property
    def is_compiled(self) -> bool:
        return not self.refused and self.bytes <= MOST_BYTES

    def line(self) -> str:
        """Why it does not count."""
        return self.refused or f"a table of {self.bytes} bytes"


@dataclass(frozen=True)
class Made:
    """A file that compiled, with the counts and values of the points at which it is judged."""

    name: str
    file: Path
    precise: Precise
    counts: np.ndarray  # [input, point]
    x: np.ndarray


def listed() -> dict[str, str]:
    """Names by file name in the folder."""
    return tomllib.loads((root() / LIST).read_text())["files"]


def found_files() -> Path:
    """With QUIESCE_BUILD set: as they are there. UsageError where they cannot be had."""
    if not os.environ.get("QUIESCE_BUILD"):
        build("tools/benchmarks/fetch_peers", "foreign")
    folder = build_folder() / "deps/foreign/files"
    missing = [name for name in listed() if not (folder / name).is_file()]
    if missing:
        raise UsageError(
            f"{shown(folder / missing[0])} is missing; run ./tools/benchmarks/fetch_peers foreign"
        )
    return folder


def make(name: str, file: Path) -> Made | Tried:
    try:
        precise = compile_precisely(read_system(file))
    except (UsageError, BenchFailure) as error:
        why = one_line(error).split(": ", 1)[-1]
        return Tried(name, 0, None, "", why)
    compiled, inputs = precise.compiled, precise.compiled.system.inputs
    if 100.0 * precise.error > MOST_ERROR_PCT:
        return Tried(name, 0, None, "", f"answers up to {100.0 * precise.error:.2g} % off")
    rng = np.random.default_rng(SEED)
    counts = np.array(
        [
            compiled.input_integer(i, rng.uniform(one.minimum, one.maximum, POINTS))
            for i, one in enumerate(inputs)
        ]
    )
    x = np.array([compiled.input_value(i, row) for i, row in enumerate(counts)])
    return Made(name, file, precise, counts, x)


def judge(made: Made, answer: Answer | None) -> Tried:
    """answer: pyfuzzylite's; None: nobody asked it."""
    compiled = made.precise.compiled
    size = WORD_BYTES * len(compiled.words)
    if answer is None or isinstance(answer, str):
        return Tried(made.name, size, 100.0 * made.precise.error, "float64", "")
    out, defaults = SystemEngine(compiled).evaluate(made.counts)
    wanted = evaluate(compiled.system, list(made.x))
    worst = 0.0
    for i, output in enumerate(compiled.system.outputs):
        is_judged = (wanted.strongest[i] >= WEAKEST) & ((defaults >> i & 1) == 0)
        off = np.abs(compiled.output_value(i, out[i]) - answer[:, i])[is_judged]
        worst = max(worst, float(off.max(initial=0.0)) / (output.maximum - output.minimum))
    return Tried(made.name, size, 100.0 * worst, "pyfuzzylite", "")


def measure_foreign() -> list[Tried]:
    """UsageError where the files cannot be had."""
    folder, names = found_files(), listed()
    progress = Progress(len(names))
    made: list[Made | Tried] = []
    for file, name in names.items():
        made.append(make(name, folder / file))
        progress.done(name)
    asked = [one for one in made if isinstance(one, Made) and one.file.suffix == ".fll"]
    jobs = [Job(one.file.read_text(), one.x.T) for one in asked]
    answers = dict(zip((one.file for one in asked), pyfuzzylite(jobs), strict=True))
    return [judge(one, answers.get(one.file)) if isinstance(one, Made) else one for one in made]


def compiled_pct(tried: Sequence[Tried]) -> float:
    return 100.0 * sum(one.is_compiled for one in tried) / len(tried)


def worst_error_pct(tried: Sequence[Tried]) -> float:
    return max(one.error_pct or 0.0 for one in tried if one.is_compiled)


def rows(tried: Sequence[Tried]) -> list[dict]:
    return [asdict(one) for one in tried]


def foreign_table(tried: Sequence[Tried]) -> str:
    left_out = [[one.name, one.line()] for one in tried if not one.is_compiled]
    compiled = [one for one in tried if one.is_compiled]
    asked = [one for one in compiled if one.against == "pyfuzzylite"]
    sizes = sorted(one.bytes for one in compiled)
    head = (
        f"rule files of other projects: {len(compiled)} of {len(tried)} compile within "
        f"{MOST_BYTES} bytes, half of them within {sizes[len(sizes) // 2]}; "
        f"{len(asked)} compared with pyfuzzylite"
    )
    return head + "\n" + format_table(["that do not", "why"], left_out)


def gaussian_system() -> System:
    """A controller with four Gaussian sets on each of two inputs, AND as product, a constant for
    every pair."""
    sets = tuple(SetTerm(f"s{k}", Curve("Gaussian", gaussian(k / 3.0, 0.15))) for k in range(4))
    inputs = tuple(SystemInput(name, 0.0, 1.0, sets) for name in ("x", "y"))
    terms = tuple(ConstantTerm(f"c{k}", k / 15.0) for k in range(16))
    output = SystemOutput("z", 0.0, 1.0, terms, BY_RULE, UNBOUNDED_SUM, 0, 0.0)
    rules = tuple(
        SystemRule(
            0,
            Join(AND, (Proposition(True, 0, i), Proposition(True, 1, j))),
            (Conclusion(0, 4 * i + j),),
        )
        for i in range(4)
        for j in range(4)
    )
    blocks = (Block("AlgebraicProduct", "Maximum", "Minimum"),)
    return System("gaussians", inputs, (output,), blocks, rules)


def gaussian_bytes() -> int:
    """Of its table, the one that answers within .03 %."""
    made = compile_precisely(gaussian_system())
    if made.error > 1e-3:
        raise BenchFailure(f"the Gaussian controller answers {100.0 * made.error:.2g} % off")
    return WORD_BYTES * len(made.compiled.words)
