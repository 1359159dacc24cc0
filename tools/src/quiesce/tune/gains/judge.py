"""Settings run on all records: a recipe's table with a tracker, on the bench, beside constants."""

import tempfile
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from quiesce.base.errors import UsageError
from quiesce.compare.figures import Figures, index
from quiesce.compare.laws import ComparedLaw
from quiesce.compare.records import Record
from quiesce.compare.run import Case, Comparison
from quiesce.engine.bench import setting_options
from quiesce.law.recipe import Made, Recipe, make
from quiesce.law.rig import LawRig
from quiesce.table.file import SUFFIX, table_bytes
from quiesce.tune.gains.aim import Runs
from quiesce.tune.gains.defaults import INDEX
from quiesce.tune.gains.space import Space
from quiesce.tune.gains.trials import Trial


@dataclass(frozen=True)
class Tunable:
    """A recipe on a rig with its tracker ("" where it demands currents), and what is searched."""

    recipe: Recipe
    rig: LawRig
    space: Space
    tracker: str = ""
    map_file: Path | None = None

    def made(self, values: dict[str, float]) -> Made:
        """UsageError where the recipe refuses them."""
        return make(self.recipe, self.rig, self.space.settings(values))

    def words(self, values: dict[str, float]) -> list[int]:
        """Of the table. UsageError where there is no such one."""
        try:
            return self.made(values).table.words()
        except ValueError as error:
            raise UsageError(f"{self.recipe.name}: {error}")

    def file(self, values: dict[str, float]) -> bytes:
        """Of the table, for the rig's board. UsageError likewise."""
        return table_bytes(self.words(values), self.rig.board_crc32)

    def parameters(self, values: dict[str, float]) -> dict[str, int | str]:
        """Of the controller, beside the table."""
        tracker = {"tracker": self.tracker} if self.tracker else {}
        return {**tracker, **self.space.parameters(values)}

    @contextmanager
    def law(self, values: dict[str, float]) -> Iterator[ComparedLaw]:
        """For the bench; its table is in a file as long as this lasts. UsageError as of `words`."""
        data = self.file(values)
        settings = [f"{name}={value}" for name, value in self.parameters(values).items()]
        of_map = ("--force-map", str(self.map_file)) if self.map_file else ()
        with tempfile.NamedTemporaryFile(prefix="quiesce-tune-", suffix=SUFFIX) as file:
            file.write(data)
            file.flush()
            options = ("--law-table", file.name, *of_map, *setting_options(settings))
            yield ComparedLaw(self.recipe.name, self.made(values).table.law, options)


@dataclass(frozen=True)
class Judge:
    """run: of Comparison.ready. all_current: what indices are ratios to, by record and seed."""

    run: Callable[[Case], Figures]
    records: Sequence[Record]
    seeds: Sequence[int]
    all_current: dict[tuple[str, int], Figures]

    def trial(self, tunable: Tunable, values: dict[str, float]) -> Trial:
        """From several threads at once. What recipe or bench refuses has no runs."""
        try:
            with tunable.law(values) as law:
                return Trial(values, {one.name: self._runs(law, one) for one in self.records})
        except UsageError as error:
            return Trial(values, {}, str(error))

    def _runs(self, law: ComparedLaw, record: Record) -> Figures:
        found = [self.run(Case(law, record, seed)) for seed in self.seeds]
        bases = [self.all_current[record.name, seed] for seed in self.seeds]
        return means(found, bases)


def means(figures: Sequence[Figures], all_current: Sequence[Figures]) -> Figures:
    """Over seeds, with the index."""
    indices = [index(own, base) for own, base in zip(figures, all_current, strict=True)]
    found = {name: float(np.mean([one[name] for one in figures])) for name in figures[0]}
    return {**found, INDEX: float(np.mean(indices))}


def constant_runs(
    on: Comparison, records: Sequence[Record], seeds: Sequence[int], workers: int
) -> tuple[list[Runs], dict[tuple[str, int], Figures]]:
    """Of Comparison.constants, and the figures of all current that judge everything else."""
    laws = on.constants()
    cases = [Case(law, r, seed) for law in laws for r in records for seed in seeds]
    flat = on.figures(cases, workers)
    found = {
        (case.law.label, case.record.name, case.seed): one
        for case, one in zip(cases, flat, strict=True)
    }
    bases = {(r.name, seed): found[laws[-1].label, r.name, seed] for r in records for seed in seeds}
    runs = [
        {
            r.name: means(
                [found[law.label, r.name, seed] for seed in seeds],
                [bases[r.name, seed] for seed in seeds],
            )
            for r in records
        }
        for law in laws
    ]
    return runs, bases
