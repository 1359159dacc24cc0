"""One search from its options to its result: what `quiesce rules optimize` does."""

import hashlib
from collections.abc import Sequence
from concurrent.futures import Executor
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from quiesce.base.progress import say
from quiesce.engine.bench import Bench
from quiesce.engine.scenarios import Scenario
from quiesce.rules.integers.controller import require_controller_shape
from quiesce.rules.model import RuleBase
from quiesce.rules.optimize import state as optimize_state
from quiesce.rules.optimize.evaluate import ClosedLoop, bench_digest
from quiesce.rules.optimize.genes import Genome, Space, make_space
from quiesce.rules.optimize.lookup import Sweep, best_constants, sweep
from quiesce.rules.optimize.methods import NSGA2, Settings
from quiesce.rules.optimize.objective import Objective, Outcome
from quiesce.rules.optimize.result import Found, FrontPoint, NoiseCheck
from quiesce.rules.optimize.run import Limits, Problem, Runner, simplify
from quiesce.rules.optimize.scenarios import Steadies, steady_scenarios
from quiesce.rules.optimize.search import make_search
from quiesce.rules.optimize.start import recipe_base
from quiesce.rules.optimize.state import State

CONSTANT_STEP_mA, FEWEST_STEPS = 250, 8
CHECK_SEEDS = (101, 102, 103)
# A gene that changes the cost by less than this (%) goes back to what it was.
WORTH_pct = 0.005
FRONT_SHOWN = 40


@dataclass(frozen=True)
class Task:
    """What the user asked for."""

    scenarios: Sequence[Scenario]
    start: RuleBase
    tune: Sequence[str]
    settings: Settings
    objective: Objective
    seed: int
    limits: Limits
    params: Sequence[str]  # NAME=VALUE, for every run
    command: str


def start_from_recipe(
    bench: Bench, folder: Path, steady: Steadies, max_current_A: float, pool: Executor
) -> RuleBase:
    """The published recipe on a plant; for the published plant, the rules that ship."""
    freqs = ", ".join(f"{freq_Hz:g}" for freq_Hz in steady.freqs_Hz)
    say(f"start: the published recipe, constant currents swept at {freqs} Hz")
    swept = steady_scenarios(
        bench, folder, steady.plant, steady.freqs_Hz, steady.drives_V, steady.settle_s
    )
    top_mA = round(1000 * max_current_A)
    found = sweep(ClosedLoop(bench, swept), top_mA, constant_step_mA(top_mA), pool)
    return recipe_base(found, "recipe", max_current_A)


def constant_step_mA(top_mA: int) -> int:
    """So that a driver of a small current has several steps, too."""
    return max(1, min(CONSTANT_STEP_mA, top_mA // FEWEST_STEPS))


def file_digest(file: Path) -> str:
    return hashlib.sha256(file.read_bytes()).hexdigest()[:16]


def search_settings(task: Task) -> dict[str, Any]:
    """All that the result depends on but the number of generations; values of JSON."""
    return {
        **asdict(task.settings),
        "seed": task.seed,
        "tune": list(task.tune),
        "weights": list(task.objective.weights),
        "max_current_A": task.objective.max_current_A,
        "scenarios": [
            [s.name, file_digest(s.file), file_digest(s.plant_file)] for s in task.scenarios
        ],
        "start": hashlib.sha256(repr(task.start).encode()).hexdigest()[:16],
        "set": list(task.params),
        "bench": bench_digest(),
    }


def make_problem(space: Space, loop: ClosedLoop, task: Task) -> Problem:
    objective = task.objective
    return Problem(
        canonical=space.canonical,
        evaluate=lambda genome: loop.of_rules(space.decode(genome)),
        costs=objective.several if task.settings.method == NSGA2 else objective.single,
        cost=objective.cost,
    )


class Session:
    """Prepares a search, which refuses what cannot be searched, then runs it."""

    def __init__(self, bench: Bench, task: Task, pool: Executor) -> None:
        require_controller_shape(task.start)
        self._task = task
        self._pool = pool
        self.space = make_space(task.start, task.tune)
        self._loop = ClosedLoop(bench, task.scenarios, task.params)
        self._problem = make_problem(self.space, self._loop, task)
        self.settings = search_settings(task)

    def state(self, file: Path, is_resumed: bool) -> State:
        if not is_resumed:
            return State(self.settings)
        state = optimize_state.load(file, self.settings, self.space.levels, len(self._loop.places))
        state.is_finished = False
        say(f"resuming after generation {len(state.digests)}, {len(state.evaluated)} known")
        return state

    def run(self, state: State, file: Path) -> Found:
        task, space = self._task, self.space
        start_outcome = self._loop.of_rules(task.start)
        first = space.encode(task.start)
        runner = Runner(self._problem, state, file, self._pool)
        rng = np.random.default_rng(task.seed)
        runner.run(make_search(space.levels, first, task.settings, rng), task.limits)
        say("setting back what does not pay")
        start_genome = space.canonical(first)
        genome = simplify(runner, self._problem, runner.best(), start_genome, WORTH_pct)
        runner.finish()
        return self._found(runner, genome, start_outcome)

    def _found(self, runner: Runner, genome: Genome, start_outcome: Outcome) -> Found:
        task, objective = self._task, self._task.objective
        best = replace(self.space.decode(genome), name=f"{task.start.name}_optimised")
        outcome = runner.visited[genome]
        # The start itself may lie between two codes and be better than both.
        if objective.cost(outcome) >= objective.cost(start_outcome):
            best, outcome = task.start, start_outcome
        constants = self._sweep()
        return Found(
            start=task.start,
            best=best,
            places=self._loop.places,
            start_outcome=start_outcome,
            best_outcome=outcome,
            constants=best_constants(constants, objective),
            constant_sweep=constants,
            objective=objective,
            history=runner.history,
            evaluations=len(runner.visited),
            front=self._front(runner) if task.settings.method == NSGA2 else (),
            checks=self._checks(best),
            settings=self.settings,
            command=task.command,
        )

    def _sweep(self) -> Sweep:
        say("for comparison: constant currents")
        top_mA = round(1000 * self._task.objective.max_current_A)
        return sweep(self._loop, top_mA, constant_step_mA(top_mA), self._pool)

    def _checks(self, best: RuleBase) -> list[NoiseCheck]:
        """Start and best under noise that the search has not seen."""
        checks = []
        for seed in CHECK_SEEDS:
            loop = self._loop.with_options(["--seed", str(seed)])
            costs = [self._task.objective.cost(loop.of_rules(b)) for b in (self._task.start, best)]
            checks.append(NoiseCheck(seed, *costs))
        return checks

    def _front(self, runner: Runner) -> list[FrontPoint]:
        """Of all that was tried, what nothing beats; equal costs once, by the first objective."""
        from quiesce.base.searches import by_pymoo  # slow to load

        genomes = list(runner.visited)
        costs = self._task.objective.several([runner.visited[genome] for genome in genomes])
        costs = np.round(costs, 3)
        front = by_pymoo.front(costs)
        _, once = np.unique(costs[front], axis=0, return_index=True)
        chosen = front[once]
        if len(chosen) > FRONT_SHOWN:
            chosen = chosen[np.linspace(0, len(chosen) - 1, FRONT_SHOWN).round().astype(int)]
        return [
            FrontPoint(
                replace(self.space.decode(genomes[i]), name=f"{self._task.start.name}_front_{n}"),
                runner.visited[genomes[i]],
                costs[i],
            )
            for n, i in enumerate(chosen, start=1)
        ]
