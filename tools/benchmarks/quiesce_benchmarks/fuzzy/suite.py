"""Many random rule bases: engines and peers on each, and what comes of it."""

from collections import Counter
from collections.abc import Callable, Sequence
from contextlib import closing
from dataclasses import asdict, dataclass, field
from functools import partial
from typing import Any

from quiesce.base.errors import BenchFailure, UsageError, one_line
from quiesce.base.pools import Threads
from quiesce.base.progress import Progress
from quiesce.base.runner import mapped
from quiesce.rules.formats.files import write_text
from quiesce.rules.integers.emit import why_not_straight

from quiesce_benchmarks.fuzzy.agreement import (
    UNEXPLAINED,
    Case,
    EngineResult,
    PeerResult,
    explain,
    explain_skfuzzy,
    judge_engines,
    make_case,
)
from quiesce_benchmarks.fuzzy.peers import (
    Answer,
    Job,
    fuzzylite,
    pyfuzzylite,
    skfuzzy,
    skfuzzy_holds,
)
from quiesce_benchmarks.fuzzy.random import random_base

WORKERS = 2
RESOLUTION = 1000  # samples of the peers' centroids
LIBFUZZYLITE, PYFUZZYLITE, SKFUZZY = "libfuzzylite", "pyfuzzylite", "scikit-fuzzy"
PEERS = (LIBFUZZYLITE, PYFUZZYLITE, SKFUZZY)
Say = Callable[[str], None]


@dataclass(frozen=True)
class Budget:
    bases: int
    points: int  # of each base
    skfuzzy_points: int  # of those bases that it can hold; it takes about 20 ms each
    straight_every: int  # of the bases with straight-line C, this share is built and run: 1/N


@dataclass
class Outcome:
    """Of one base."""

    case: Case
    why_not_straight: str  # empty: straight-line C
    engines: list[EngineResult]
    peers: list[PeerResult] = field(default_factory=list)

    @property
    def is_beyond(self) -> bool:
        """The engine is outside the bound somewhere, or a peer disagrees for no known reason."""
        return any(one.beyond for one in self.engines) or any(
            UNEXPLAINED in one.differing for one in self.peers
        )

    def row(self) -> dict[str, Any]:
        random = self.case.random
        return {
            "number": random.number,
            "layout": random.layout,
            "style": random.style,
            "methods": [output.method for output in random.base.outputs],
            "rules": len(random.base.rules),
            "why_not_straight": self.why_not_straight,
            "is_beyond": self.is_beyond,
            "engines": [asdict(one) for one in self.engines],
            "peers": [asdict(one) for one in self.peers],
        }


@dataclass(frozen=True)
class RandomResult:
    outcomes: list[Outcome]
    refused: dict[int, str]  # by number: bases that the integers cannot hold, and why
    absent: list[str]  # peers that could not be had

    @property
    def tried(self) -> int:
        return len(self.outcomes)

    @property
    def beyond(self) -> int:
        return sum(outcome.is_beyond for outcome in self.outcomes)

    @property
    def compiled_pct(self) -> float | None:
        straight = sum(not outcome.why_not_straight for outcome in self.outcomes)
        return 100.0 * straight / self.tried if self.outcomes else None

    def reasons(self) -> dict[str, dict[str, int]]:
        """By peer: points that differ from the exact reference, by what explains them."""
        found: dict[str, Counter[str]] = {peer: Counter() for peer in PEERS}
        for outcome in self.outcomes:
            for peer in outcome.peers:
                found[peer.peer].update(peer.differing)
        return {peer: dict(counter) for peer, counter in found.items()}

    def peer_points(self) -> dict[str, int]:
        found: Counter[str] = Counter()
        for outcome in self.outcomes:
            for peer in outcome.peers:
                if not peer.refused:
                    found[peer.peer] += peer.points
        return dict(found)

    def fallbacks(self) -> dict[str, int]:
        """Bases without straight-line C, by the reason without its numbers and names."""
        found: Counter[str] = Counter()
        for outcome in self.outcomes:
            if outcome.why_not_straight:
                kind = "overlap" if "overlap" in outcome.why_not_straight else "size"
                found[kind] += 1
        return dict(found)

    def worst_lsb(self) -> float:
        distances = [one.worst_lsb for outcome in self.outcomes for one in outcome.engines]
        return max(distances, default=0.0)


def judge_base(number: int, seed: int, budget: Budget) -> Outcome | str:
    """Or one line why the integers cannot hold the base, or the compiler its C."""
    try:
        case = make_case(random_base(seed, number), seed, budget.points)
        why_not = why_not_straight(case.compiled)
        with_straight = not why_not and number % budget.straight_every == 0
        return Outcome(case, why_not, judge_engines(case, with_straight))
    except (UsageError, BenchFailure) as error:
        return one_line(error)


def measure_random(seed: int, budget: Budget, say: Say) -> RandomResult:
    progress = Progress(budget.bases)

    def judge(number: int) -> Outcome | str:
        result = judge_base(number, seed, budget)
        progress.done(f"random base {number}")
        return result

    with closing(Threads(WORKERS)) as pool:
        found = mapped(pool, judge, range(budget.bases))
    outcomes = [one for one in found if isinstance(one, Outcome)]
    refused = {i: one for i, one in enumerate(found) if isinstance(one, str)}
    absent = ask_peers(outcomes, budget, say)
    return RandomResult(outcomes, refused, absent)


def ask_peers(outcomes: Sequence[Outcome], budget: Budget, say: Say) -> list[str]:
    """Adds what the peers say; returns which could not be asked, and why."""
    absent = []
    asks: list[tuple[str, Callable[[], None]]] = [
        (PYFUZZYLITE, partial(ask_pyfuzzylite, outcomes)),
        (LIBFUZZYLITE, partial(ask_fuzzylite, outcomes)),
        (SKFUZZY, partial(ask_skfuzzy, outcomes, budget.skfuzzy_points)),
    ]
    for name, ask in asks:
        try:
            ask()
        except UsageError as error:
            absent.append(f"random bases, {name}: {one_line(error)}")
        say(f"random bases: {name}")
    return absent


def job(outcome: Outcome) -> Job:
    return Job(write_text(outcome.case.base, "fll"), outcome.case.points, RESOLUTION)


def keep(outcome: Outcome, peer: str, answer: Answer) -> None:
    if isinstance(answer, str):
        result = PeerResult(peer, 0, refused=answer)
    else:
        result = explain(outcome.case, peer, answer, RESOLUTION)
    outcome.peers.append(result)


def ask_pyfuzzylite(outcomes: Sequence[Outcome]) -> None:
    answers = pyfuzzylite([job(outcome) for outcome in outcomes])
    for outcome, answer in zip(outcomes, answers, strict=True):
        keep(outcome, PYFUZZYLITE, answer)


def ask_fuzzylite(outcomes: Sequence[Outcome]) -> None:
    for outcome in outcomes:
        keep(outcome, LIBFUZZYLITE, fuzzylite(job(outcome)))


def ask_skfuzzy(outcomes: Sequence[Outcome], points: int) -> None:
    held = [outcome for outcome in outcomes if not skfuzzy_holds(outcome.case.base)]
    jobs = [Job(one.case.base, one.case.points[:points], RESOLUTION) for one in held]
    for outcome, answer in zip(held, skfuzzy(jobs), strict=True):
        if isinstance(answer, str):
            outcome.peers.append(PeerResult(SKFUZZY, 0, refused=answer))
        else:
            outcome.peers.append(explain_skfuzzy(outcome.case, answer))
