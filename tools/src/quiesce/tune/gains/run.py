"""The whole of `quiesce tune law`: constants, trials, what came out, files."""

import hashlib
from collections.abc import Sequence
from contextlib import closing
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from quiesce.base.errors import UsageError
from quiesce.base.paths import results_folder
from quiesce.base.progress import Progress
from quiesce.compare.records import Record
from quiesce.compare.run import Comparison, Shaking
from quiesce.engine.bench import Bench
from quiesce.engine.pool import run_all
from quiesce.law.recipe import Recipe
from quiesce.law.rig import load_rig
from quiesce.tune.gains.aim import Aim, Runs
from quiesce.tune.gains.defaults import INDEX
from quiesce.tune.gains.judge import Judge, Tunable, constant_runs
from quiesce.tune.gains.search import search
from quiesce.tune.gains.space import space_of
from quiesce.tune.gains.trials import Trial, TrialStore, key_of

RATE_Hz = 1000  # that tables are made for: the default of tick_rate_Hz
INVERSE = "inverse"


@dataclass(frozen=True)
class Order:
    """What the user asked for."""

    recipe: Recipe
    plant: Path
    board: Path
    records: Sequence[Record]
    shaking: Shaking
    seeds: int
    tracker: str | None  # None: the recipe's
    map_file: Path | None
    fixed: Sequence[str]
    asked: Sequence[str]
    aim: Aim
    trials: int
    seed: int
    jobs: int
    out: Path | None
    is_fresh: bool
    command: str  # as it can be typed again
    shared: Sequence[str]  # words of it that `quiesce compare` takes alike: structure and motions

    @property
    def folder(self) -> Path:
        return self.out or results_folder() / "tune" / f"{self.recipe.name}_{self.board.stem}"


@dataclass(frozen=True)
class Tuned:
    """trials: in the order that they were asked for, the first with the values that it started
    from. constants: from no current to all."""

    order: Order
    tunable: Tunable
    trials: list[Trial]
    constants: list[Runs]
    is_interrupted: bool

    def cost(self, runs: Runs) -> float:
        return self.order.aim.cost(runs) if runs else float("inf")

    @property
    def start(self) -> Trial:
        return self.trials[0]

    @property
    def best(self) -> Trial:
        return min(self.trials, key=lambda one: self.cost(one.runs))


def tune(order: Order) -> Tuned:
    """UsageError for what cannot be tuned; nothing is written then, but finished trials."""
    bench = Bench()
    on = Comparison(bench, order.plant, order.board, order.shaking)
    known = [INDEX, *on.figure_names]
    if order.aim.figure not in known:
        raise UsageError(
            f"--figure {order.aim.figure}: this structure has {', '.join(known)}; a contact's are "
            "of plants with one"
        )
    tunable = tunable_of(order, bench)
    tunable.words(tunable.space.start)
    seeds = range(1, order.seeds + 1)
    with (
        closing(
            TrialStore(order.folder, inputs_of(order, tunable, bench), order.is_fresh)
        ) as store,
        on.ready(order.records) as run,
    ):
        constants, all_current = constant_runs(on, order.records, seeds, order.jobs)
        judge = Judge(run, order.records, seeds, all_current)
        asked = Asked(order, tunable, judge, store, bench)
        first = tunable.space.point(tunable.space.start)
        # Where the start is inside of its bounds, it is the first point, too.
        is_inside = tunable.space.values(first) == tunable.space.start
        left = order.trials if is_inside else order.trials - 1
        is_interrupted = False
        try:
            asked.start()
            search(asked, first, left, order.seed)
        except KeyboardInterrupt:
            if not asked.trials():
                raise
            is_interrupted = True
        return Tuned(order, tunable, asked.trials(), constants, is_interrupted)


def tunable_of(order: Order, bench: Bench) -> Tunable:
    recipe = order.recipe
    tracker = order.tracker if order.tracker is not None else recipe.tracker
    if order.tracker and not recipe.tracker:
        raise UsageError(f"--tracker: {recipe.name} demands currents; it has no tracker")
    if tracker == INVERSE and order.map_file is None:
        raise UsageError(
            f"{recipe.name} with tracker {INVERSE} needs a damper's map, --map FILE (quiesce "
            "identify inverse); or take another --tracker"
        )
    if order.map_file is not None and not order.map_file.is_file():
        raise UsageError(f"--map: there is no file {order.map_file}")
    rig = load_rig(bench, order.board, order.plant, RATE_Hz)
    space = space_of(recipe, rig, tracker, order.fixed, order.asked)
    return Tunable(recipe, rig, space, tracker, order.map_file)


def inputs_of(order: Order, tunable: Tunable, bench: Bench) -> dict[str, Any]:
    """What a trial's figures depend on, beside its values."""

    def digest(*parts: bytes) -> str:
        return hashlib.sha256(b"".join(parts)).hexdigest()[:16]

    files = {"plant": order.plant, "board": order.board, "bench": bench.executable}
    records = [one.name.encode() + one.accel_m_s2.tobytes() for one in order.records]
    return {
        "recipe": order.recipe.name,
        **{name: digest(file.read_bytes()) for name, file in files.items()},
        "map": digest(order.map_file.read_bytes()) if order.map_file else None,
        "tracker": tunable.tracker,
        "records": digest(*records, *(f"{one.rate_Hz!r}".encode() for one in order.records)),
        "shaking": repr(order.shaking),
        "seeds": order.seeds,
    }


class Asked:
    """What the search asks for: points in the unit cube, answered by costs."""

    def __init__(
        self, order: Order, tunable: Tunable, judge: Judge, store: TrialStore, bench: Bench
    ) -> None:
        self._order, self._tunable, self._judge = order, tunable, judge
        self._store, self._bench = store, bench
        self._values: dict[str, dict[str, float]] = {}  # asked for, in order
        self._progress = Progress(order.trials)
        self._best = float("inf")

    def start(self) -> None:
        """The first trial. UsageError where it is refused: so is what the user asked for."""
        found = self._found([self._tunable.space.start])[0]
        if found.refused:
            raise UsageError(found.refused)

    def __call__(self, points: np.ndarray) -> np.ndarray:
        values = [self._tunable.space.values(point) for point in points]
        return np.array([self._cost(one) for one in self._found(values)])

    def trials(self) -> list[Trial]:
        """Those that are finished."""
        found = [self._store.find(one) for one in self._values.values()]
        return [one for one in found if one is not None]

    def _found(self, wanted: Sequence[dict[str, float]]) -> list[Trial]:
        new = {key_of(one): one for one in wanted if key_of(one) not in self._values}
        self._values.update(new)
        missing = [one for one in new.values() if self._store.find(one) is None]
        self._progress.skip(len(new) - len(missing))
        run_all(self._bench, [partial(self._try, one) for one in missing], self._order.jobs)
        found = [self._store.find(one) for one in wanted]
        return [one for one in found if one is not None]

    def _try(self, values: dict[str, float]) -> None:
        trial = self._judge.trial(self._tunable, values)
        self._store.add(trial)
        cost = self._cost(trial)
        self._best = min(self._best, cost)
        told = f"{cost:.4g}" if trial.runs else "refused"
        self._progress.done(f"{self._order.recipe.name}: {told}, best {self._best:.4g}")

    def _cost(self, trial: Trial) -> float:
        return self._order.aim.cost(trial.runs) if trial.runs else float("inf")
