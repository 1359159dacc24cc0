"""Every recipe with as many settings on the same records, and what was chosen of them."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

from quiesce.base.errors import UsageError
from quiesce.compare.records import Record
from quiesce.compare.run import Comparison
from quiesce.engine.bench import Bench
from quiesce.engine.pool import WORKERS, run_work
from quiesce.law.recipe import Recipe
from quiesce.law.recipes import RECIPES
from quiesce.tune.gains.aim import Aim, Runs
from quiesce.tune.gains.judge import Judge, Tunable, constant_runs
from quiesce.tune.gains.search import spread
from quiesce.tune.gains.space import PROPORTIONAL, space_of
from quiesce.tune.gains.trials import Trial

from quiesce_benchmarks.laws import rigs

INVERSE = "inverse"
Trials = list[Trial]  # the first with the settings as they come


@dataclass(frozen=True)
class Candidate:
    label: str
    tunable: Tunable

    def settings(self, count: int, seed: int) -> list[dict[str, float]]:
        """As they come, then points spread evenly; fewer where there is nothing to search."""
        space = self.tunable.space
        if not space.searched:
            return [space.start]
        points = spread(count - 1, len(space.searched), seed)
        return [space.start, *(space.values(point) for point in points)]


@dataclass(frozen=True)
class Tried:
    """trials: by label of the law. constants: from no current to all, by record."""

    trials: dict[str, Trials]
    constants: list[Runs]

    def untuned(self, label: str) -> Runs | None:
        """With the settings as they come; None where those were refused."""
        return self.trials[label][0].runs or None

    def run(self) -> dict[str, Trials]:
        """Those of which at least one setting ran."""
        return {
            label: [one for one in own if one.runs]
            for label, own in self.trials.items()
            if any(one.runs for one in own)
        }

    def refused(self) -> dict[str, str]:
        """Why not one setting of a law ran."""
        left = set(self.trials) - set(self.run())
        return {label: self.trials[label][0].refused for label in sorted(left)}


def candidates(
    rig: str, start: Mapping[str, Mapping[str, float]], map_file: Path | None
) -> list[Candidate]:
    """All recipes. start: settings of the first trial that a unit of the rig asks for. Without a
    map forces are tracked in proportion to what a force sensor measures."""
    found = []
    for recipe in RECIPES:
        tracker = recipe.tracker
        if tracker == INVERSE and map_file is None:
            tracker = PROPORTIONAL
        found.append(_candidate(recipe, rig, tracker, start, map_file))
        if tracker == "compare":
            found.append(_candidate(recipe, rig, PROPORTIONAL, start, None))
    return found


def _candidate(
    recipe: Recipe, rig: str, tracker: str, start: Mapping[str, Mapping[str, float]],
    map_file: Path | None,
) -> Candidate:  # fmt: skip
    of_rig = rigs.law_rig(rig)
    space = space_of(recipe, of_rig, tracker)
    space = replace(space, start={**space.start, **start.get(recipe.name, {})})
    of_map = map_file if tracker == INVERSE else None
    own = tracker in ("", recipe.tracker)
    label = recipe.name if own else f"{recipe.name}, {tracker}"
    return Candidate(label, Tunable(recipe, of_rig, space, tracker, of_map))


def try_all(
    on: Comparison, own: Sequence[Candidate], records: Sequence[Record], count: int, seed: int
) -> Tried:
    """So many settings of each on all records."""
    constants, all_current = constant_runs(on, records, [seed], WORKERS)
    with on.ready(records) as run:
        judge = Judge(run, records, [seed], all_current)
        pieces = [
            (f"{one.label}, setting {i}", one.label, partial(judge.trial, one.tunable, values))
            for one in own
            for i, values in enumerate(one.settings(count, seed))
        ]
        found = run_work(Bench(), [(text, work) for text, _, work in pieces])
    trials: dict[str, Trials] = {one.label: [] for one in own}
    for (_, label, _), trial in zip(pieces, found, strict=True):
        trials[label].append(trial)
    return Tried(trials, constants)


def cost(aim: Aim, runs: Runs, without: str | None = None) -> float:
    """Over all records but one."""
    return aim.cost({name: own for name, own in runs.items() if name != without})


def best(aim: Aim, trials: Trials, without: str | None = None) -> Trial:
    return min(trials, key=lambda one: cost(aim, one.runs, without))


def best_constant(aim: Aim, constants: Sequence[Runs], without: str | None = None) -> Runs:
    return min(constants, key=lambda one: cost(aim, one, without))


def chosen_law(aim: Aim, tried: Mapping[str, Trials], without: str) -> tuple[str, Trial]:
    """The law and its settings that are best on all other records."""
    if not tried:
        raise UsageError("no law ran")
    found = {label: best(aim, own, without) for label, own in tried.items()}
    label = min(found, key=lambda one: cost(aim, found[one].runs, without))
    return label, found[label]


def cell(value: float | None) -> str:
    """Of a table."""
    return "refused" if value is None else f"{value:.3f}"
