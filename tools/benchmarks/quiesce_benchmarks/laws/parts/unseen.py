"""Records that no law was tuned or chosen on: for each of the seven, law and settings that are best
on the other six."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from quiesce.base.table import format_table
from quiesce.compare.records import Record
from quiesce.compare.run import Comparison, Shaking
from quiesce.engine.pool import WORKERS
from quiesce.tune.gains.aim import Aim, Runs
from quiesce.tune.gains.defaults import INDEX
from quiesce.tune.gains.judge import Judge, constant_runs
from quiesce.tune.gains.trials import Trial

from quiesce_benchmarks.laws import rigs, tuned
from quiesce_benchmarks.laws.tuned import Candidate, Trials, Tried
from quiesce_benchmarks.part import Effort, Measured

TITLE = "unseen: each record judged by law and settings that are best on the others"
FIGURES = (
    ("index_unseen_mean", "1", 0.94, "lower"),
    ("index_unseen_worst", "1", 1.0, "lower"),
    ("beats_hindsight_constant_of", "records", 5.0, "higher"),
    ("index_unseen_untuned_mean", "1", None, "lower"),
)
SETTINGS, QUICK_SETTINGS = 16, 2
QUICK_RECORDS = 5  # the shortest
SEEDS = 3  # that what was chosen is judged by
# Of the first trial, where a unit of the rig asks for more than the recipe's own: the building's
# first frequency, its first storey, forces and strokes of its damper.
START = {
    "lyapunov": {"natural_Hz": 5.5},
    "clipped_optimal": {"force_1_N2": 1e-10},
    "modulated_friction": {"gain_N_m": 4e5},
    "polynomial": {"e2_A_s_m": 15.0},
    "backstepping": {"mass_kg": 98.3, "stiffness_N_m": 5.16e5, "damping_N_s_m": 125.0},
}
AIM = Aim()


def comparison() -> Comparison:
    peak = rigs.el_centro().peak_m_s2
    return rigs.comparison(rigs.BUILDING, Shaking(rigs.FIVE_TIMES, scale_to_m_s2=peak))


def measure(effort: Effort) -> Measured:
    records, on = rigs.records(), comparison()
    if effort.is_quick:
        records = tuple(sorted(records, key=lambda one: one.duration_s)[:QUICK_RECORDS])
    own = tuned.candidates(rigs.BUILDING, START, None)
    count = QUICK_SETTINGS if effort.is_quick else SETTINGS
    tried = tuned.try_all(on, own, records, count, effort.seed)
    seeds = range(effort.seed, effort.seed + (1 if effort.is_quick else SEEDS))
    return judged(on, own, tried, records, seeds)


def judged(
    on: Comparison, own: Sequence[Candidate], tried: Tried, records: Sequence[Record],
    seeds: Sequence[int],
) -> Measured:  # fmt: skip
    """What was chosen on the others runs with further noise on the record that is left."""
    run = tried.run()
    chosen = {one.name: tuned.chosen_law(AIM, run, one.name) for one in records}
    untuned = {label: tried.trials[label][:1] for label in run if tried.untuned(label)}
    as_come = {one.name: tuned.chosen_law(AIM, untuned, one.name)[1] for one in records}
    constants, all_current = constant_runs(on, records, seeds, WORKERS)
    tunables = {one.label: one.tunable for one in own}
    unseen: dict[str, float] = {}
    for record in records:
        label, trial = chosen[record.name]
        with on.ready([record]) as ready:
            again = Judge(ready, [record], seeds, all_current).trial(tunables[label], trial.values)
        unseen[record.name] = again.runs[record.name][INDEX]
    hindsight = {one.name: min(runs[one.name][INDEX] for runs in constants) for one in records}
    values: dict[str, float | None] = {
        "index_unseen_mean": float(np.mean(list(unseen.values()))),
        "index_unseen_worst": max(unseen.values()),
        "beats_hindsight_constant_of": float(sum(unseen[n] < hindsight[n] for n in unseen)),
        "index_unseen_untuned_mean": float(np.mean([as_come[n].runs[n][INDEX] for n in as_come])),
    }
    laws = {label: law_data(label, tried, records) for label in run}
    reported = {
        "chosen": {name: {"law": law, **trial.values} for name, (law, trial) in chosen.items()},
        "index": unseen,
        "hindsight_constant": hindsight,
        "settings_of_each": max(len(own) for own in tried.trials.values()),
        "laws": laws,
        "refused": tried.refused(),
    }
    labels = {name: law for name, (law, _) in chosen.items()}
    return Measured(values, reported, (laws_table(laws), records_table(labels, unseen, hindsight)))


def left_out(trials: Trials, records: Sequence[Record]) -> list[float]:
    """Index on each record of the settings that are best on the others."""
    return [tuned.best(AIM, trials, one.name).runs[one.name][INDEX] for one in records]


def law_data(label: str, tried: Tried, records: Sequence[Record]) -> dict[str, Any]:
    """Of one law on this structure; constants are chosen like settings, on the other records."""
    trials = tried.run()[label]
    own = left_out(trials, records)
    as_constants = [Trial({}, dict(runs)) for runs in tried.constants]
    constants = left_out(as_constants, records)
    off = indices(tried.constants[0], records)
    hindsight = [min(runs[one.name][INDEX] for runs in tried.constants) for one in records]
    as_it_comes = tried.untuned(label)
    untuned = indices(as_it_comes, records) if as_it_comes else None
    mean = float(np.mean(own))
    return {
        "structure": rigs.BUILDING,
        "index_tuned": mean,
        "index_tuned_worst": max(own),
        "index_untuned": float(np.mean(untuned)) if untuned else None,
        "index_untuned_worst": max(untuned) if untuned else None,
        "index_passive_off": float(np.mean(off)),
        "index_best_constant": float(np.mean(constants)),
        "index_hindsight_constant": float(np.mean(hindsight)),
        "beats_passive_off": bool(mean < np.mean(off)),
        "beats_best_constant": bool(mean < np.mean(constants)),
        "beats_hindsight_constant_of": sum(a < b for a, b in zip(own, hindsight, strict=True)),
        "settings": tuned.best(AIM, trials).values,
    }


def indices(runs: Runs, records: Sequence[Record]) -> list[float]:
    return [runs[one.name][INDEX] for one in records]


def laws_table(laws: dict[str, dict[str, Any]]) -> str:
    head = ["law", "tuned on the others: mean", "worst", "as it comes: mean", "worst", "beats"]
    names = ("index_tuned", "index_tuned_worst", "index_untuned", "index_untuned_worst")
    rows = [
        [label, *(tuned.cell(one[name]) for name in names), str(one["beats_hindsight_constant_of"])]
        for label, one in sorted(laws.items(), key=lambda x: x[1]["index_tuned"])
    ]
    first = next(iter(laws.values()))
    for label, name in (
        ("constant of hindsight", "index_hindsight_constant"),
        ("constant, best on the others", "index_best_constant"),
        ("no current", "index_passive_off"),
    ):
        rows.append([label, f"{first[name]:.3f}", "", "", "", ""])
    return format_table(head, rows)


def records_table(
    chosen: dict[str, str], unseen: dict[str, float], hindsight: dict[str, float]
) -> str:
    rows = [[n, chosen[n], f"{unseen[n]:.3f}", f"{hindsight[n]:.3f}"] for n in chosen]
    return format_table(["record", "chosen on the others", "index", "best constant"], rows, (0, 1))
