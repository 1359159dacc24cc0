"""Runs a search: evaluates its populations in parallel, keeps its state, tells how it goes."""

from collections.abc import Callable, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from quiesce.base.errors import UsageError
from quiesce.base.paths import shown
from quiesce.base.progress import Progress
from quiesce.rules.optimize.genes import Genome
from quiesce.rules.optimize.objective import Outcome
from quiesce.rules.optimize.search import Costs, Search
from quiesce.rules.optimize.state import ANEW, State, digest


@dataclass(frozen=True)
class Problem:
    """What is searched, whatever is behind it."""

    canonical: Callable[[Genome], Genome]
    evaluate: Callable[[Genome], Outcome]  # called from several threads
    costs: Callable[[Sequence[Outcome]], Costs]  # what the method sees
    cost: Callable[[Outcome], float]  # one figure, to tell the best


@dataclass(frozen=True)
class Limits:
    generations: int
    evaluations: int | None = None  # ends after the generation that reaches it


@dataclass
class History:
    """Figures after each generation."""

    best: list[float] = field(default_factory=list)  # so far
    mean: list[float] = field(default_factory=list)  # of the generation
    evaluations: list[int] = field(default_factory=list)  # different rule bases so far


class Runner:
    """One search with its state. Interrupted at any point, what was evaluated is in the file."""

    def __init__(self, problem: Problem, state: State, file: Path, pool: Executor) -> None:
        self._problem = problem
        self._pool = pool
        self.state = state
        self._file = file
        self._visited: dict[Genome, Outcome] = {}  # in the order of this run
        self.history = History()

    @property
    def visited(self) -> dict[Genome, Outcome]:
        return self._visited

    def best(self) -> Genome:
        """Of all visited, the one of least cost; the first of equals."""
        return min(self._visited, key=lambda genome: self._problem.cost(self._visited[genome]))

    def run(self, search: Search, limits: Limits) -> None:
        progress = Progress(limits.generations)
        genomes = next(search)
        for generation in range(limits.generations):
            outcomes = self.evaluate(genomes)
            self._finish(generation, genomes, outcomes)
            progress.done(self._headline())
            if limits.evaluations is not None and len(self._visited) >= limits.evaluations:
                break
            if generation + 1 < limits.generations:
                genomes = search.send(self._problem.costs(outcomes))

    def evaluate(self, genomes: Sequence[Genome]) -> list[Outcome]:
        """Outcomes; what is known is not run again. Keeps what is done where it is interrupted."""
        named = [self._problem.canonical(genome) for genome in genomes]
        known = self.state.evaluated
        new = [genome for genome in dict.fromkeys(named) if genome not in known]
        futures = {genome: self._pool.submit(self._problem.evaluate, genome) for genome in new}
        try:
            for genome, future in futures.items():
                known[genome] = future.result()
        except BaseException:
            for future in futures.values():
                future.cancel()
            self.state.save(self._file)
            raise
        self._visited.update((genome, known[genome]) for genome in named)
        return [known[genome] for genome in named]

    def finish(self) -> None:
        self.state.is_finished = True
        self.state.save(self._file)

    def _finish(
        self, generation: int, genomes: Sequence[Genome], outcomes: Sequence[Outcome]
    ) -> None:
        self._check_digest(generation, digest(genomes))
        cost = [self._problem.cost(outcome) for outcome in outcomes]
        history = self.history
        history.best.append(min([*history.best[-1:], *cost]))
        history.mean.append(float(np.mean(cost)))
        history.evaluations.append(len(self._visited))

    def _check_digest(self, generation: int, now: str) -> None:
        """Saves a new generation; of one that is in the file, checks that it is the same."""
        digests = self.state.digests
        if generation >= len(digests):
            digests.append(now)
            self.state.save(self._file)
        elif digests[generation] != now:
            raise UsageError(
                f"{shown(self._file)} does not repeat: generation {generation + 1} is not what it "
                f"was (another version of this command, of numpy or pymoo?); {ANEW}"
            )

    def _headline(self) -> str:
        history = self.history
        return (
            f"best cost {history.best[-1]:.3f}, generation's mean {history.mean[-1]:.3f}, "
            f"{history.evaluations[-1]} rule bases tried"
        )


def simplify(
    runner: Runner, problem: Problem, best: Genome, start: Genome, tolerance: float
) -> Genome:
    """The best with every gene that does not pay set back to the start's.

    Rules that no scenario reaches are left to chance by any search; this takes that back. A gene
    goes back where the cost rises by no more than `tolerance` over that of the best.
    """
    limit = problem.cost(runner.evaluate([best])[0]) + tolerance
    kept = best
    for i, gene in enumerate(start):
        if kept[i] != gene:
            tried = problem.canonical((*kept[:i], gene, *kept[i + 1 :]))
            if problem.cost(runner.evaluate([tried])[0]) <= limit:
                kept = tried
    return kept
