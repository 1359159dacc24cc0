"""Whatever a law sees and whatever its table holds: no current where the damper would have to give
power, none beyond what a driver takes."""

from collections.abc import Sequence

from quiesce.base.errors import UsageError, one_line
from quiesce.base.table import format_table
from quiesce.engine.bench import Bench
from quiesce.engine.pool import run_work

from quiesce_benchmarks.laws import law_cases, law_runs
from quiesce_benchmarks.laws.law_cases import LawCase
from quiesce_benchmarks.laws.law_runs import ALONE, SPOIL, WHOLE, Run
from quiesce_benchmarks.part import Effort, Measured

TITLE = "bounded: laws and trackers on any picture, with tables spoilt"
FIGURES = (
    ("law_energised_ticks", "ticks", 0.0, "lower"),
    ("law_beyond_ticks", "ticks", 0.0, "lower"),
    ("law_fuzz_ticks", "ticks", None, "higher"),
    ("law_fuzz_tables", "tables", None, "higher"),
    ("law_fuzz_tables_accepted", "tables", None, "higher"),
)
TICKS, QUICK_TICKS = 300_000, 30_000  # a law and tracker, in each of the two ways
WHOLE_TICKS = 20_000


def runs_of(case: LawCase, ticks: int, seed: int) -> list[Run]:
    """Alone with its good table, with tables spoilt, and the whole controller."""
    counts = law_runs.counts_of(case.rig, WHOLE_TICKS, seed)
    orders = [
        law_runs.order(case, ALONE, ticks, seed, None),
        law_runs.order(case, SPOIL, ticks, seed + 1, None),
        law_runs.order(case, WHOLE, WHOLE_TICKS, seed, counts),
    ]
    return [law_runs.on_host(order) for order in orders]


def row_of(case: LawCase, runs: Sequence[Run]) -> dict[str, float]:
    alone, spoilt, whole = runs
    return {
        "ticks": alone["trial_ticks"] + spoilt["trial_ticks"],
        "energised": alone["energised_ticks"] + spoilt["energised_ticks"],
        "beyond": sum(run["beyond_ticks"] for run in (alone, spoilt, whole)),
        "with_current": alone["current_ticks"] / alone["trial_ticks"],
        "tables": spoilt["tables"],
        "accepted": spoilt["accepted"],
    }


def measure(effort: Effort) -> Measured:
    ticks = QUICK_TICKS if effort.is_quick else TICKS
    cases = [case for group in law_cases.all_cases() for case in group]

    def work(case: LawCase) -> dict[str, float] | str:
        try:
            return row_of(case, runs_of(case, ticks, effort.seed))
        except UsageError as error:
            return f"not run: {case.label}: {one_line(str(error))}"

    done = run_work(Bench(), [(one.label, lambda one=one: work(one)) for one in cases])
    found = {c.label: r for c, r in zip(cases, done, strict=True) if not isinstance(r, str)}
    not_run = [one for one in done if isinstance(one, str)]
    values: dict[str, float | None] = {
        f"law_{figure}": sum(row[key] for row in found.values())
        for figure, key in (
            ("energised_ticks", "energised"),
            ("beyond_ticks", "beyond"),
            ("fuzz_ticks", "ticks"),
            ("fuzz_tables", "tables"),
            ("fuzz_tables_accepted", "accepted"),
        )
    }
    return Measured(values, {"laws": found}, ("\n".join([table(found), *not_run]),))


def table(found: dict[str, dict[str, float]]) -> str:
    head = ["law", "ticks", "energised", "beyond", "with current, %", "tables spoilt", "accepted"]
    rows = [
        [
            label,
            *(f"{row[key]:.0f}" for key in ("ticks", "energised", "beyond")),
            f"{100.0 * row['with_current']:.0f}",
            *(f"{row[key]:.0f}" for key in ("tables", "accepted")),
        ]
        for label, row in found.items()
    ]
    return format_table(head, rows, (0,))
