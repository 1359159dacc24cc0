"""How many small mistakes in the guarding code the C tests and the golden streams notice."""

import random
import sys
import tempfile
import tomllib
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from quiesce.base.errors import BenchFailure

from quiesce_benchmarks.trust.c_tests import Build
from quiesce_benchmarks.trust.mutate import Mutant, enums, mutants_of
from quiesce_benchmarks.trust.trial import Outcome, Trial

# What keeps a mistake elsewhere from reaching a coil.
FILES = (
    "firmware/guard/*.c",
    "firmware/guard/*.h",
    "firmware/chain/drive.[ch]",
    "firmware/comm/e2e.[ch]",
    "firmware/comm/can_receive.[ch]",
    "firmware/comm/freshness.[ch]",
    "firmware/base/twin.h",
)
STATES = "firmware/include/quiesce.h"
EQUIVALENTS = Path(__file__).with_name("equivalents.toml")
SEED = 20261123
COUNT = 300


@dataclass(frozen=True)
class Result:
    tried: int
    killed: int
    equivalent: int  # by the argument in EQUIVALENTS
    survivors: list[Mutant]

    @property
    def killed_pct(self) -> float:
        return 100.0 * self.killed / (self.tried - self.equivalent)

    @property
    def equivalent_pct(self) -> float:
        return 100.0 * self.equivalent / self.tried


def pool(root: Path) -> list[Mutant]:
    """All that there are."""
    files = sorted({file for pattern in FILES for file in root.glob(pattern)})
    states = enums([(root / STATES).read_bytes()])
    found = []
    for file in files:
        source = file.read_bytes()
        found += mutants_of(str(file.relative_to(root)), source, states + enums([source]))
    return found


def entries(mutants: Sequence[Mutant]) -> list[Mutant]:
    """Those of the supervisor's table: they are all tried, and counted for themselves."""
    return [one for one in mutants if one.kind == "entry"]


def drawn(mutants: Sequence[Mutant], seed: int) -> list[Mutant]:
    """All others, in the order in which they are tried."""
    others = [one for one in mutants if one.kind != "entry"]
    random.Random(seed).shuffle(others)
    return others


def equivalents(mutants: Sequence[Mutant], file: Path = EQUIVALENTS) -> dict[str, str]:
    """Key -> why no test can notice it. BenchFailure where one is of code that has changed."""
    rows: list[dict[str, Any]] = tomllib.loads(file.read_text()).get("equivalent", [])
    found = {row["mutant"]: row["why"].strip() for row in rows}
    known = {one.key for one in mutants}
    for key, why in found.items():
        if key not in known:
            raise BenchFailure(f"{file.name}: no such mutant any more: {key}")
        if not why:
            raise BenchFailure(f"{file.name}: no argument for {key}")
    return found


def judged(outcomes: Sequence[Outcome], argued: dict[str, str]) -> Result:
    """Counts them. BenchFailure where one that is argued to be equivalent was killed."""
    alive = [one.mutant for one in outcomes if one.killed_by is None]
    for one in outcomes:
        if one.killed_by is not None and one.mutant.key in argued:
            raise BenchFailure(f"not equivalent, {one.killed_by} kills it: {one.mutant.key}")
    survivors = [one for one in alive if one.key not in argued]
    equivalent = len(alive) - len(survivors)
    return Result(len(outcomes), len(outcomes) - len(alive), equivalent, survivors)


def distinct(outcomes: Sequence[Outcome]) -> list[Outcome]:
    """Without what is no mutant, and one of those that are the same machine code."""
    found: dict[tuple[str, str], Outcome] = {}
    for one in outcomes:
        if one.is_mutant:
            found.setdefault((one.mutant.path, one.code), one)
    return list(found.values())


def tried(trial: Trial, mutants: Sequence[Mutant], count: int) -> list[Outcome]:
    """The first count of them that are any."""
    outcomes: list[Outcome] = []
    at = 0
    while len(distinct(outcomes)) < count and at < len(mutants):
        batch = mutants[at : at + count - len(distinct(outcomes))]
        at += len(batch)
        for one in trial.try_all(batch):
            outcomes.append(one)
            tell(one, len(outcomes))
    return distinct(outcomes)


def tell(outcome: Outcome, number: int) -> None:
    if outcome.is_mutant and outcome.killed_by is None:
        mutant = outcome.mutant
        print(f"      survives: {line_of(mutant)}", file=sys.stderr, flush=True)
    if number % 50 == 0:
        print(f"      {number} tried", file=sys.stderr, flush=True)


def line_of(mutant: Mutant) -> str:
    return f"{mutant.path}:{mutant.line}: {mutant.key.split(': ', 1)[1]}"


def measure(
    root: Path, build: Path, count: int | None, seed: int, jobs: int
) -> tuple[Result, Result]:
    """Of the code, count of them (None: all), and of the supervisor's table, all."""
    mutants = pool(root)
    argued = equivalents(mutants)
    with tempfile.TemporaryDirectory(prefix="quiesce-mutants-") as folder:
        trial = Trial(Build(build), root, Path(folder), jobs)
        code = tried(trial, drawn(mutants, seed), count or len(mutants))
        table = entries(mutants)
        return judged(code, argued), judged(tried(trial, table, len(table)), argued)
