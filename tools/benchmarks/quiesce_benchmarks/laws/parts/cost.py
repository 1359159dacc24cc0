"""What every law costs on the emulated Cortex-M4, and its words there against those of the host."""

from dataclasses import dataclass
from typing import Any

from quiesce.base.errors import UsageError, one_line
from quiesce.base.table import format_table
from quiesce.engine.bench import Bench
from quiesce.engine.pool import run_work
from quiesce.law.recipes import RECIPES
from quiesce.law.tables import FORMS, table_of_words

from quiesce_benchmarks.laws import law_cases, law_runs
from quiesce_benchmarks.laws.law_cases import LawCase
from quiesce_benchmarks.laws.law_runs import ALONE, WHOLE, Run
from quiesce_benchmarks.part import Effort, Measured

TITLE = "cost: instructions and RAM of every law, and the same words on host and image"
MOST_INSTR = 6000.0
NAMES = (*law_cases.built_in(), *(recipe.name for recipe in RECIPES))
FIGURES = (
    *((f"instr_{name}", "instr", MOST_INSTR, "lower") for name in NAMES),
    ("law_instr_worst", "instr", MOST_INSTR, "lower"),
    ("law_instr_worst_any_tracker", "instr", MOST_INSTR, "lower"),
    ("law_state_bytes_worst", "byte", None, "lower"),
    ("law_mismatched_words", "words", 0.0, "lower"),
    ("law_compared_words", "words", None, "higher"),
    ("law_cases_not_run", "cases", 0.0, "lower"),
)
TICKS, QUICK_TICKS = 20000, 4000
# Of the ticks with the output on: a run without them says nothing of a law.
LEAST_RUNNING = 0.5


@dataclass(frozen=True)
class Cost:
    """Of one law with one tracker. whole: the controller's tick; alone: law and tracker."""

    case: LawCase
    whole: Run
    alone: Run
    added_mean: float  # of the tick, against law off on the same signals
    mismatched: int
    compared: int

    def row(self) -> dict[str, Any]:
        return {
            "law": self.case.law,
            "tracker": self.case.tracker,
            "rig": self.case.rig,
            "tick_worst_instr": self.whole.worst,
            "tick_mean_instr": self.whole.mean,
            "added_mean_instr": self.added_mean,
            "own_worst_instr": self.alone.worst,
            "own_mean_instr": self.alone.mean,
            "state_bytes": self.alone["state_bytes"],
            "table_words": len(self.case.words),
            "map_words": len(self.case.map_words),
            "running_ticks": self.whole["running_ticks"],
            "signals": signals(self.case),
        }


def signals(case: LawCase) -> list[str]:
    """That its table names, each once; none of a law that no recipe makes."""
    if not case.words or case.words[0] not in FORMS:
        return []
    return list(dict.fromkeys(one.name for one in table_of_words(case.words).signals()))


def both(case: LawCase, mode: int, ticks: int, seed: int) -> tuple[Run, Run]:
    """Host and image."""
    counts = law_runs.counts_of(case.rig, ticks, seed) if mode == WHOLE else None
    words = law_runs.order(case, mode, ticks, seed, counts)
    return law_runs.on_host(words), law_runs.on_image(words)


def off_mean(rig: str, ticks: int, seed: int) -> float:
    off = LawCase("off", "off", "", rig, (), ())
    words = law_runs.order(off, WHOLE, ticks, seed, law_runs.counts_of(rig, ticks, seed))
    return law_runs.on_image(words).mean


def cost_of(case: LawCase, ticks: int, seed: int, off_instr: float) -> Cost:
    """UsageError where the controller refuses the law as it is here, or hardly runs."""
    host, whole = both(case, WHOLE, ticks, seed)
    if whole["running_ticks"] < LEAST_RUNNING * ticks:
        raise UsageError(f"its output was on in {whole['running_ticks']} of {ticks} ticks")
    host_alone, alone = both(case, ALONE, ticks, seed)
    pairs = ((host, whole), (host_alone, alone))
    return Cost(
        case,
        whole,
        alone,
        whole.mean - off_instr,
        sum(law_runs.words_apart(*pair, ticks) for pair in pairs),
        sum(ticks * one["words_a_tick"] for one, _ in pairs),
    )


def costs(
    cases: list[LawCase], ticks: int, seed: int, bench: Bench
) -> tuple[list[Cost], list[str]]:
    """And why others have none, a line each."""
    off = {rig: off_mean(rig, ticks, seed) for rig in {case.rig for case in cases}}

    def work(case: LawCase) -> Cost | str:
        try:
            return cost_of(case, ticks, seed, off[case.rig])
        except UsageError as error:
            return f"{case.label}: {one_line(str(error))}"

    found = run_work(bench, [(one.label, lambda one=one: work(one)) for one in cases])
    return [one for one in found if isinstance(one, Cost)], [
        one for one in found if isinstance(one, str)
    ]


def measure(effort: Effort) -> Measured:
    ticks = QUICK_TICKS if effort.is_quick else TICKS
    groups = law_cases.all_cases()
    # Of a law with forces the first is with its own tracker; quick: the others are left out.
    cases = [case for group in groups for case in (group[:1] if effort.is_quick else group)]
    found, not_run = costs(cases, ticks, effort.seed, Bench())
    own = {group[0].name: group[0] for group in groups}
    of_law = {cost.case.name: cost for cost in found if cost.case == own[cost.case.name]}
    values: dict[str, float | None] = {
        f"instr_{name}": cost.whole.worst for name, cost in of_law.items()
    }
    values["law_instr_worst"] = max(cost.whole.worst for cost in of_law.values())
    values["law_instr_worst_any_tracker"] = max(cost.whole.worst for cost in found)
    values["law_state_bytes_worst"] = max(cost.alone["state_bytes"] for cost in found)
    values["law_mismatched_words"] = sum(cost.mismatched for cost in found)
    values["law_compared_words"] = sum(cost.compared for cost in found)
    values["law_cases_not_run"] = len(not_run)
    reported = {
        "costs": {cost.case.label: cost.row() for cost in found},
        "own": [cost.case.label for cost in of_law.values()],  # with its own tracker
        "not_run": not_run,
        "ticks": ticks,
    }
    return Measured(values, reported, (table(found, not_run),))


HEAD = ("law", "tracker", "tick worst", "mean", "added", "its own worst", "mean",
        "state, bytes", "table, words")  # fmt: skip


def table(found: list[Cost], not_run: list[str]) -> str:
    rows = [cells(cost.case.name, cost.row()) for cost in found]
    return "\n".join([format_table(list(HEAD), rows, (0, 1)), *(f"not run: {x}" for x in not_run)])


def cells(name: str, row: dict[str, Any]) -> list[str]:
    keys = ("tick_worst_instr", "tick_mean_instr", "added_mean_instr", "own_worst_instr",
            "own_mean_instr", "state_bytes", "table_words")  # fmt: skip
    return [name, row["tracker"] or "-", *(f"{row[key]:.0f}" for key in keys)]
