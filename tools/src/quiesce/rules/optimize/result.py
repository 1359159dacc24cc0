"""What a search found, as tables and as JSON."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from operator import attrgetter
from typing import Any

import numpy as np

from quiesce.base.table import format_table
from quiesce.hil.published import load_reference
from quiesce.rules.model import AND, RuleBase
from quiesce.rules.optimize.evaluate import Place
from quiesce.rules.optimize.lookup import Sweep, lookup_json, lookup_table
from quiesce.rules.optimize.objective import PARTS, Objective, Outcome, Steady
from quiesce.rules.optimize.run import History


@dataclass(frozen=True)
class FrontPoint:
    """A rule base that no other tried one beats in every objective."""

    base: RuleBase
    outcome: Outcome
    costs: np.ndarray  # of the objective's names


@dataclass(frozen=True)
class NoiseCheck:
    """Costs under a noise that the search has not seen."""

    seed: int
    start: float
    best: float


@dataclass(frozen=True)
class Found:
    """A finished search. Sequences over places have one entry for every steady state."""

    start: RuleBase
    best: RuleBase
    places: Sequence[Place]
    start_outcome: Outcome
    best_outcome: Outcome
    constants: Sequence[tuple[int, Steady]]  # best constant current, mA, by the objective
    constant_sweep: Sweep
    objective: Objective
    history: History
    evaluations: int
    front: Sequence[FrontPoint]
    checks: Sequence[NoiseCheck]
    settings: dict[str, Any]
    command: str

    @property
    def constant_outcome(self) -> Outcome:
        return tuple(steady for _, steady in self.constants)

    @property
    def is_better(self) -> bool:
        return self.best != self.start


def bound_of(place: Place) -> tuple[float, float] | None:
    """The best that any current waveform does, where an independent source tells it."""
    reference = load_reference()
    if not reference.covers(place.scenario.plant_file, place.drive_V):
        return None
    return reference.bound(place.freq_Hz)


FIGURES = attrgetter("amp_reduction_pct", "accel_rms_reduction_pct", "mean_current_A")
Figures = list[float | None]


def place_figures(found: Found, i: int) -> Figures:
    outcomes = (found.start_outcome, found.best_outcome, found.constant_outcome)
    limits = bound_of(found.places[i]) or (None, None)
    return [*(figure for outcome in outcomes for figure in FIGURES(outcome[i])), *limits]


def means(rows: Sequence[Figures]) -> Figures:
    """None where a place has no figure."""
    return [None if None in column else np.mean(column) for column in zip(*rows, strict=True)]


HEAD = [
    "scenario", "Hz||g", "start: x %||z.1f", "a %||z.1f", "A||.2f", "found: x %||z.1f", "a %||z.1f",
    "A||.2f", "constant: x %||z.1f", "a %||z.1f", "A||.2f", "any: x %||z.1f", "a %||z.1f",
]  # fmt: skip
HEAD_NOTE = (
    "Reductions against 0 A with the same excitation (negative: worse): x displacement amplitude, "
    "a RMS\nacceleration; A mean current. constant: the best constant current by the same "
    "objective, swept; what a\nsettled table of rules can reach. any: the best that any current "
    "waveform does, each figure alone."
)


def comparison_table(found: Found) -> str:
    figures = [place_figures(found, i) for i in range(len(found.places))]
    rows = [
        [place.scenario.name, place.freq_Hz, *row]
        for place, row in zip(found.places, figures, strict=True)
    ]
    return format_table(HEAD, [*rows, ["mean", "", *means(figures)]])


def cost_table(found: Found) -> str:
    """The objective's parts and the cost, of start, found and the best constant currents."""
    rows = []
    for name, outcome in (
        ("start", found.start_outcome),
        ("found", found.best_outcome),
        ("best constant currents", found.constant_outcome),
    ):
        rows.append([name, *found.objective.parts(outcome), found.objective.cost(outcome)])
    weights = [f"x {weight:g}" for weight in found.objective.weights]
    head = ["left, %", *(f"{part}||.2f" for part in PARTS), "cost||.3f"]
    return format_table(head, [["weights", *weights, ""], *rows])


def check_table(found: Found) -> str:
    head = ["noise seed", "cost: start||.3f", "found||.3f"]
    return format_table(head, [(c.seed, c.start, c.best) for c in found.checks], left=())


def rule_table(base: RuleBase) -> str:
    """Table VIII: rows the first input's sets, columns the second's, entries the term.

    Rule by rule where the base is no such table.
    """
    terms: dict[tuple[int, int], str] = {}
    for rule in base.rules:
        inputs = {condition.input: condition for condition in rule.conditions}
        plain = rule.connective == AND and not any(c.negated for c in rule.conditions)
        where = (inputs[0].set, inputs[1].set) if sorted(inputs) == [0, 1] else None
        if where is None or where in terms or not plain or rule.weight != 1:
            return "\n".join(base.rule_text(rule) for rule in base.rules)
        term = rule.conclusions[0]
        terms[where] = "-" if term is None else base.outputs[0].terms[term].name
    rows, columns = base.inputs[0].sets, base.inputs[1].sets
    head = [f"{base.inputs[0].name} \\ {base.inputs[1].name}", *(one.name for one in columns)]
    body = [
        [one.name, *(terms.get((i, j), "-") for j in range(len(columns)))]
        for i, one in enumerate(rows)
    ]
    return format_table(head, body)


def set_lines(base: RuleBase) -> list[str]:
    """Where sets and terms lie."""
    lines = []
    for variable in base.inputs:
        sets = (f"{s.name} {' '.join(f'({x:.4g}, {mu:g})' for x, mu in s.points)}"
                for s in variable.sets)  # fmt: skip
        lines.append(f"{variable.name}: {'; '.join(sets)}")
    for output in base.outputs:
        terms = [
            f"{term.name} {term.value:.4g}" if hasattr(term, "value") else term.name
            for term in output.terms
        ]
        lines.append(f"{output.name}: {'; '.join(terms)}")
    return lines


def outcome_json(outcome: Outcome) -> list[dict[str, float]]:
    return [asdict(steady) for steady in outcome]


def result_json(found: Found) -> dict[str, Any]:
    """The object of result.json."""
    return {
        "settings": found.settings,
        "command": found.command,
        "evaluations": found.evaluations,
        "generations": len(found.history.best),
        "is_better": found.is_better,
        "cost": {
            "start": found.objective.cost(found.start_outcome),
            "found": found.objective.cost(found.best_outcome),
            "best_constant": found.objective.cost(found.constant_outcome),
        },
        "places": [
            {
                "scenario": place.scenario.name,
                "freq_hz": place.freq_Hz,
                "drive_V": place.drive_V,
                "bound_pct": bound_of(place),
                "start": asdict(found.start_outcome[i]),
                "found": asdict(found.best_outcome[i]),
                "best_constant": {"current_mA": found.constants[i][0]}
                | asdict(found.constants[i][1]),
            }
            for i, place in enumerate(found.places)
        ],
        "history": asdict(found.history),
        "noise_checks": [asdict(check) for check in found.checks],
        "front": [
            {"costs": point.costs.tolist(), "outcome": outcome_json(point.outcome)}
            for point in found.front
        ],
        "lookup": lookup_json(found.constant_sweep),
    }


def text_sections(found: Found) -> list[tuple[str, str]]:
    """Titles and plain text of the report, and of what the command prints."""
    sections = [
        ("Reductions by steady state", f"{comparison_table(found)}\n\n{HEAD_NOTE}"),
        ("Objective", cost_table(found)),
        ("Under other noise", check_table(found)),
        ("Table VIII, start", rule_table(found.start)),
        ("Table VIII, found", rule_table(found.best)),
        ("Sets, start", "\n".join(set_lines(found.start))),
        ("Sets, found", "\n".join(set_lines(found.best))),
        ("Table VII: constant current of least RMS acceleration", lookup_table(
            found.constant_sweep)),
    ]  # fmt: skip
    if found.front:
        sections.append(("Pareto front", front_table(found)))
    return sections


def front_table(found: Found) -> str:
    head = ["rule file", *(f"{name} left %||.2f" for name in found.objective.names)]
    rows = enumerate(found.front, start=1)
    return format_table(head, [(f"front_{i:02}.fcl", *point.costs) for i, point in rows])
