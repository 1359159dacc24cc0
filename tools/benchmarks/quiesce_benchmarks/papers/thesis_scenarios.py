"""Scenarios A to D of the thesis: the published parameter sets as they are, ours fitted again, and
one model over all currents."""

from collections.abc import Callable, Sequence

import numpy as np
from quiesce.base.table import format_table
from quiesce.damper.candidates import Choice, parametric_candidates, setting_of
from quiesce.damper.data.record import Record
from quiesce.damper.data.split import Segment, whole
from quiesce.damper.fit.problem import Problem
from quiesce.damper.fit.search import Effort
from quiesce.damper.fit.small import fit_small
from quiesce.damper.fit_model import simulate_values
from quiesce.damper.model_file import DamperModel
from quiesce.damper.score import Simulate
from quiesce.damper.simulate import simulator

from quiesce_benchmarks.damper.one_set import error_pct, learn_anfis, scenario_errors
from quiesce_benchmarks.papers import thesis_published as published

Errors = dict[str, list[float]]
Column = Callable[[int, float], DamperModel]

HEADINGS = {
    "modified_bouc_wen": "modified Bouc-Wen",
    "kwok_tanh": "hysteretic (tanh)",
    "anfis9": "ANFIS, 9 rules",
    "anfis27": "ANFIS, 27 rules",
}
PARAMETRIC = {"modified_bouc_wen": published.bouc_wen_at, "kwok_tanh": published.tanh_at}
# Enough for three cycles of one motion; of one over all currents the laws are the thesis': linear,
# and for the hysteretic model's one parameter of second order.
EFFORT = Effort(population=16, generations=8, polished=2, polish_evaluations=20)
QUICK_EFFORT = Effort(population=8, generations=3, polished=1, polish_evaluations=6)
COEFFICIENTS = {"modified_bouc_wen": 2, "kwok_tanh": 3}


def fitted(name: str, segments: Sequence[Segment], seed: int, effort: Effort) -> Simulate:
    choice = Choice(rig=(), most_coefficients=COEFFICIENTS[name])
    problem = Problem(setting_of(parametric_candidates()[name], segments, choice), segments)
    return simulate_values(problem, fit_small(problem, seed, effort).values)


def published_scenarios(records: Sequence[Record]) -> dict[str, Errors]:
    """Of the published sets against the restored recording, by model and scenario."""
    return {
        **{name: of_columns(column, records) for name, column in PARAMETRIC.items()},
        "anfis9": of_anfis9(records),
        "anfis27": {
            "A": [error_pct(simulator(published.file_of("anfis27")), one) for one in records]
        },
    }


def of_columns(column: Column, records: Sequence[Record]) -> Errors:
    def error(k: int, at: int) -> float:
        return error_pct(simulator(column(k, published.CURRENTS_A[at])), records[at])

    middle, last = published.MIDDLE, len(records) - 1
    each = range(len(records))
    return {
        "A": [error(k, k) for k in each],
        "B": [error(k, middle) for k in each],
        "C": [error(middle, k) for k in each],
        "D": [error(last, k) for k in each],
    }


def of_anfis9(records: Sequence[Record]) -> Errors:
    own = [simulator(published.file_of(f"anfis9_{at:.1f}A")) for at in published.CURRENTS_A]
    return {
        "A": [error_pct(one, record) for one, record in zip(own, records, strict=True)],
        "B": [error_pct(one, records[published.MIDDLE]) for one in own],
    }


def own_scenarios(
    records: Sequence[Record], seed: int, is_quick: bool, say: Callable[[str], None]
) -> dict[str, Errors]:
    """Each model fitted to one current with constants: it has no law for the others."""
    effort = QUICK_EFFORT if is_quick else EFFORT
    learners: dict[str, Callable[[Sequence[Segment]], Simulate]] = {
        name: lambda segments, n=name: fitted(n, segments, seed, effort)  # type: ignore[misc]
        for name in PARAMETRIC
    }
    learners["anfis9"] = lambda segments: learn_anfis(segments, seed)
    out = {}
    for name, learn in learners.items():
        out[name] = scenario_errors(records, learn, published.MIDDLE)
        say(f"scenarios, {HEADINGS[name]}")
    return out


def one_set(
    fitted_to: Sequence[Record],
    judged_on: Sequence[Record],
    seed: int,
    is_quick: bool,
    say: Callable[[str], None],
) -> dict[str, list[float]]:
    """One model over all currents: error in % by current, on cycles with other noise."""
    effort = QUICK_EFFORT if is_quick else EFFORT
    segments = [whole(one) for one in fitted_to]
    models = {"anfis27": learn_anfis(segments, seed)}
    for name in PARAMETRIC:
        models[name] = fitted(name, segments, seed, effort)
        say(f"one set, {HEADINGS[name]}")
    return {name: [error_pct(one, record) for record in judged_on] for name, one in models.items()}


def table_of(
    published_again: dict[str, Errors], own: dict[str, Errors], one: dict[str, list[float]]
) -> str:
    """Printed, the printed parameters run here, and fitted here."""
    rows = []

    def add(name: str, scenario: str, what: str, values: Sequence[float]) -> None:
        cells = [f"{value:.2f}" for value in values]
        rows.append([HEADINGS[name], scenario, what, *cells, f"{np.mean(values):.2f}"])

    for name, by_scenario in published.ERRORS_pct.items():
        for scenario, values in by_scenario.items():
            add(name, scenario, "printed", values)
            add(name, scenario, "printed set, run here", published_again[name][scenario])
            if name in own:
                add(name, scenario, "fitted here", own[name][scenario])
    for name, values in one.items():
        add(name, "all", "one set, fitted here", values)
    head = ["model", "", "", *(f"{at:g} A" for at in published.CURRENTS_A), "mean"]
    title = "the thesis' scenarios, 10 Hz, +-1.5 mm: error, % of the force"
    return f"{title}\n{format_table(head, rows, left=(0, 1, 2))}"
