"""One parameter set over five currents: 10 mm at 1 Hz of the measured damper, and the thesis'
scenarios on it.

A: one model a current. B: each of those at 0.5 A. C: the one fitted at 0.5 A for all currents.
D: the one fitted at 1 A for all currents. A model of one current has no law for the others, so B to
D use what it says with its constants; "one set" is a single model with current laws.
"""

from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path

import numpy as np
from quiesce.base.table import format_table
from quiesce.damper.candidates import Choice, parametric_candidates, setting_of
from quiesce.damper.data.record import Record
from quiesce.damper.data.split import Segment, whole
from quiesce.damper.fit.grown import grown_fit
from quiesce.damper.fit.problem import Problem
from quiesce.damper.fit.small import fit_small
from quiesce.damper.fit_model import simulate_values
from quiesce.damper.score import Simulate, score

from quiesce_benchmarks.report import Figure

HELD_OUT_A = 0.5
IN_SAMPLE_GOAL_pct, HELD_OUT_GOAL_pct = 4.0, 5.5
NETWORK = "viscoplastic_2"
# Rows of the table: what the thesis fitted, and ours.
MODELS = ("modified_bouc_wen", "kwok_tanh", NETWORK)
HEADINGS = {
    "modified_bouc_wen": "modified Bouc-Wen",
    "kwok_tanh": "hysteretic (Kwok tanh)",
    NETWORK: "viscoplastic network, 2 elements",
    "anfis": "ANFIS, 9 rules",
}


def records_of_test(folder: Path) -> list[Record]:
    """The five records, by rising current."""
    from quiesce.damper.data.records import records_of_set

    from quiesce_benchmarks.damper.real import rules

    entry = next(one for one in rules()["set"] if one["name"] == "utfsm_sines")
    data = records_of_set(entry, folder, rules()["displacement_low_pass_Hz"])
    chosen = [one for one in data.records if "amp_mm=10 " in one.name and "freq_hz=1 " in one.name]
    return sorted(chosen, key=lambda one: one.level or 0.0)


def fit_model(name: str, segments: Sequence[Segment], seed: int) -> Simulate:
    """A parametric model with its usual current laws."""
    candidate = parametric_candidates()[name]
    setting = setting_of(candidate, segments, Choice(rig=() if name != NETWORK else None))
    problem = Problem(setting, segments)
    if name == NETWORK:
        smaller = parametric_candidates()["viscoplastic_1"]
        first = Problem(setting_of(smaller, segments, Choice()), segments)
        found = grown_fit(problem, seed, (first, grown_fit(first, seed, None)))
    else:
        found = fit_small(problem, seed)
    return simulate_values(problem, found.values)


def learn_anfis(segments: Sequence[Segment], seed: int) -> Simulate:
    from quiesce.damper.learned import anfis
    from quiesce.damper.library import Scales

    scales = Scales.of(segments)
    return anfis.train(segments, scales, seed, anfis.Settings()).simulate


def error_pct(simulate: Simulate, record: Record) -> float:
    return 100.0 * score(simulate, [whole(record)]).error


def scenario_errors(
    records: Sequence[Record], learn: Callable[[Sequence[Segment]], Simulate], middle: int
) -> dict[str, list[float]]:
    """A to D: error in per cent by current."""
    own = [learn([whole(record)]) for record in records]
    return {
        "A": [error_pct(one, record) for one, record in zip(own, records, strict=True)],
        "B": [error_pct(one, records[middle]) for one in own],
        "C": [error_pct(own[middle], record) for record in records],
        "D": [error_pct(own[-1], record) for record in records],
    }


def learner_of(name: str, seed: int) -> Callable[[Sequence[Segment]], Simulate]:
    """Of a model's name, or "anfis"."""
    learn = learn_anfis if name == "anfis" else partial(fit_model, name)
    return lambda segments: learn(segments, seed)


def scenarios(records: Sequence[Record], seed: int, say: Callable[[str], None]) -> str:
    """Table of A to D for every model: error in per cent by current."""
    rows = []
    middle = index_of(records, HELD_OUT_A)
    for name in [*MODELS, "anfis"]:
        errors = scenario_errors(records, learner_of(name, seed), middle)
        say(f"scenarios: {HEADINGS[name]}")
        for scenario, values in errors.items():
            cells = [f"{value:.2f}" for value in values]
            rows.append([HEADINGS[name], scenario, *cells, f"{np.mean(values):.2f}"])
    head = ["model", "", *(f"{record.level:g} A" for record in records), "mean"]
    return format_table(head, rows, left=(0, 1))


def index_of(records: Sequence[Record], level: float) -> int:
    return int(np.argmin([abs((record.level or 0.0) - level) for record in records]))


def one_set(
    records: Sequence[Record], seed: int, say: Callable[[str], None]
) -> tuple[list[Figure], str]:
    """A single network over all five currents, and with one held out; the baselines beside it."""
    middle = index_of(records, HELD_OUT_A)
    fitted_rows = [whole(one) for k, one in enumerate(records) if k != middle]
    rows, figures = [], []
    for name in (NETWORK, "kwok_tanh", "zhang_tanh", "modified_bouc_wen"):
        everything = fit_model(name, [whole(one) for one in records], seed)
        held = fit_model(name, fitted_rows, seed)
        say(f"one set: {name}")
        errors = [error_pct(everything, record) for record in records]
        held_out = error_pct(held, records[middle])
        rows.append([name, *(f"{e:.2f}" for e in errors), f"{np.mean(errors):.2f}"])
        rows[-1].append(f"{held_out:.2f}")
        if name == NETWORK:
            figures = [
                Figure(
                    "one_set_in_sample_pct",
                    float(np.mean(errors)),
                    "%",
                    IN_SAMPLE_GOAL_pct,
                    "lower",
                ),
                Figure("one_set_held_out_pct", held_out, "%", HELD_OUT_GOAL_pct, "lower"),
            ]
    head = ["one set", *(f"{record.level:g} A" for record in records), "mean"]
    return figures, format_table([*head, f"{HELD_OUT_A:g} A held out"], rows, left=(0,))
