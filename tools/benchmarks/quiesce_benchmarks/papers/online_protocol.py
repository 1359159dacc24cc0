"""The 24 sines and the chirps: the self-tuning fuzzy model on line, and models fitted to the sines.

The source prints curves, no errors (Figs 7, 17 to 22), and two sentences that can be tested: the
adaptive model is best at low currents, and what is left of its error lies where the velocity is
near zero. Here the rig's damper is one of the models that the source prints; the other one it
prints, and Bingham's for 1.5 A, stand beside it as they are.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np
from quiesce.base.table import format_table
from quiesce.damper.candidates import Choice
from quiesce.damper.data.record import Record
from quiesce.damper.data.split import Segment
from quiesce.damper.identify import identify
from quiesce.damper.model_file import read_model
from quiesce.damper.online import FROZEN, RATES, Stream, adapted, untrained
from quiesce.damper.score import Simulate
from quiesce.damper.simulate import simulator
from quiesce.damper.task import Plan

from quiesce_benchmarks.papers.online_changes import BOUC_WEN, TANH
from quiesce_benchmarks.papers.online_rig import Rig, damper_file, protocol, recorded
from quiesce_benchmarks.part import Effort

BINGHAM = "rd1005_bingham"
# Of every sine, what models are fitted to: periods enough, and not the run-up.
FITTED_s = (4.0, 6.0)
QUICK_s = 4.0
QUICK_FITTED_s = (2.0, 3.0)
# Near zero: below this part of a test's largest speed.
SLOW_PART = 0.2


def measured(effort: Effort) -> tuple[dict[str, Any], str]:
    """Errors by test, and a table."""
    tests = protocol().tests
    if effort.is_quick:
        tests = [one for one in tests if one.current_A in (0.0, 1.5) and one.freq_Hz in (1.0, 2.5)]
    duration_s = QUICK_s if effort.is_quick else None
    low_s, high_s = QUICK_FITTED_s if effort.is_quick else FITTED_s
    records = [recorded(Rig(TANH), one, effort.seed, duration_s) for one in tests]
    sines = [
        Segment(record, round(low_s * record.rate_Hz), round(high_s * record.rate_Hz))
        for record, one in zip(records, tests, strict=True)
        if one.kind == "sine"
    ]
    models = frozen(sines, effort)
    everything = []
    for one, record in zip(tests, records, strict=True):
        adaptive, slow_share = adaptive_pct(record, sines)
        everything.append(
            {
                "kind": one.kind,
                "freq_Hz": one.freq_Hz,
                "current_A": one.current_A,
                "adaptive": adaptive,
                "adaptive_error_while_slow_pct": slow_share,
                "the last force": error_pct(
                    np.concatenate([[0.0], record.force_N[:-1]]), record, second_half(record)
                ),
                **{
                    name: error_pct(simulate(record), record, second_half(record))
                    for name, simulate in models.items()
                    if BINGHAM not in name or one.current_A == 1.5
                },
            }
        )
    return {"tests": everything, "settings": {"fitted_to_s": [low_s, high_s]}}, table_of(everything)


def frozen(sines: Sequence[Segment], effort: Effort) -> dict[str, Simulate]:
    choice = Choice(rig=("offset_N",))
    plan = Plan(FROZEN, choice, seed=effort.seed, quick=effort.is_quick, jobs=2)
    fitted = {f"{one.name}, fitted": simulator(one.damper) for one in identify(sines, [], plan)}
    published = {
        f"{name}, published": simulator(read_model(damper_file(name)))
        for name in (BOUC_WEN, BINGHAM)
    }
    return {**fitted, **published}


def adaptive_pct(record: Record, sines: Sequence[Segment]) -> tuple[float, float]:
    """Error over the second half, starting untrained with the gains of the current sweep; and the
    part of its square that lies where the velocity is near zero."""
    stream = Stream((record,), len(record))
    model = untrained(sines)
    force_N, _ = adapted(model, stream, RATES, -1, lambda _text: None)
    rows = second_half(record)
    square = (force_N - record.force_N)[rows] ** 2
    speed = np.abs(record.velocity_m_s[rows])
    slow = speed < SLOW_PART * speed.max()
    return error_pct(force_N, record, rows), 100.0 * float(square[slow].sum() / square.sum())


def second_half(record: Record) -> slice:
    return slice(len(record) // 2, None)


def error_pct(model_N: np.ndarray, record: Record, rows: slice) -> float:
    force_N = record.force_N[rows]
    return 100.0 * float(np.linalg.norm(model_N[rows] - force_N) / np.linalg.norm(force_N))


def table_of(tests: Sequence[dict[str, Any]]) -> str:
    """Means by kind and current."""
    names = [name for name in max(tests, key=len) if name not in ("kind", "freq_Hz", "current_A")]
    groups: dict[tuple[str, float], list[dict[str, Any]]] = {}
    for one in tests:
        groups.setdefault((one["kind"], one["current_A"]), []).append(one)
    rows = [
        [
            kind,
            f"{current_A:g}",
            *(
                f"{np.mean([one[name] for one in members]):.2f}" if name in members[0] else "-"
                for name in names
            ),
        ]
        for (kind, current_A), members in groups.items()
    ]
    head = ["test", "A", *(name.replace("_", " ") for name in names)]
    title = "sines and chirps, error over the second half, % of the force"
    return f"{title}\n{format_table(head, rows, left=(0,))}"
