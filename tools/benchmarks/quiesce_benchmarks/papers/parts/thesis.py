"""The thesis on the RD-8040-1, 4.3: scenarios A to D, 9 and 27 rules, both parametric models."""

import sys

import numpy as np
from quiesce.damper.data.split import whole
from quiesce.damper.score import Simulate

from quiesce_benchmarks.damper.one_set import error_pct, learn_anfis, records_of_test
from quiesce_benchmarks.damper.real import data_folder
from quiesce_benchmarks.papers import thesis_laws, thesis_spreads, thesis_test
from quiesce_benchmarks.papers import thesis_published as published
from quiesce_benchmarks.papers import thesis_scenarios as scenarios
from quiesce_benchmarks.part import Effort, Measured

TITLE = "scenarios of the RD-8040-1 thesis: ANFIS beside its parametric models"
# Printed: 3.24 to 6.40 %, 4.58 % in the mean. The mean over six currents; the worst is reported.
FIGURES = (("anfis27_one_set_pct", "%", None, "lower"),)
EPOCHS, QUICK_EPOCHS = 300, 40
DRAWS, QUICK_DRAWS = 5, 1


def say(text: str) -> None:
    print(f"papers: thesis, {text}", file=sys.stderr, flush=True)


def measure(effort: Effort) -> Measured:
    records = thesis_test.recordings(effort.seed)
    fresh = thesis_test.recordings(effort.seed + 1000)
    again = scenarios.published_scenarios(records)
    say("published sets")
    own = scenarios.own_scenarios(records, effort.seed, effort.is_quick, say)
    one = scenarios.one_set(records, fresh, effort.seed, effort.is_quick, say)
    laws = thesis_laws.drawn(records, effort.seed, QUICK_DRAWS if effort.is_quick else DRAWS)
    say("the thesis' search")
    found = thesis_spreads.spreads(records, QUICK_EPOCHS if effort.is_quick else EPOCHS)
    return Measured(
        {"anfis27_one_set_pct": float(np.mean(one["anfis27"]))},
        {
            "currents_A": list(published.CURRENTS_A),
            "printed": published.ERRORS_pct,
            "printed_sets": again,
            "fitted": own,
            "laws_by_thesis_search": laws,
            "one_set": one,
            "one_set_worst_pct": {name: float(np.max(values)) for name, values in one.items()},
            "measured_damper_anfis27_pct": on_measured_damper(effort.seed),
            "spreads": found,
        },
        (
            scenarios.table_of(again, own, one),
            thesis_laws.text_of(laws),
            thesis_spreads.text_of(found),
        ),
    )


def on_measured_damper(seed: int) -> list[float] | None:
    """27 rules over the five currents of a measured damper, 10 mm at 1 Hz; None where the
    measurements are not on this machine. Fitted rows: as the thesis judged."""
    folder = data_folder()
    if folder is None:
        return None
    records = records_of_test(folder)
    model: Simulate = learn_anfis([whole(one) for one in records], seed)
    return [error_pct(model, one) for one in records]
