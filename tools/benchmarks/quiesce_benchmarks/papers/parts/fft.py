"""The paper's frequency pipeline, a 1024-point Hann FFT with hop 50, beside the firmware's own.

Seed 000, III and IV: "the vibration frequency, which can be obtained using the FFT from the
acceleration signal".
"""

import sys

from quiesce.base.errors import UsageError
from quiesce.engine.bench import Bench, require_emulator

from quiesce_benchmarks.part import Effort, Measured
from quiesce_benchmarks.signal import accuracy, estimators

TITLE = "frequency by FFT, beside the sliding fit"
# The worst group of the gated SNRs, for both on the same records.
FIGURES = (
    ("fft_freq_rmse_over_crlb", "1", None, "lower"),
    ("fit_freq_rmse_over_crlb", "1", None, "lower"),
    ("fft_worst_tick_over_median", "1", 2.0, "lower"),
    ("fit_worst_tick_over_median", "1", None, "lower"),
)
TRIALS, QUICK_TRIALS = 200, 30
STEP_TRIALS, QUICK_STEP_TRIALS = 40, 10
TICKS, QUICK_TICKS = 100_000, 20_000


def measure(effort: Effort) -> Measured:
    quick = effort.is_quick
    trials = QUICK_TRIALS if quick else TRIALS
    groups = estimators.compare_accuracy([], effort.seed, trials, accuracy.GATED_SNRS_dB)
    steps = estimators.compare_steps([], effort.seed, QUICK_STEP_TRIALS if quick else STEP_TRIALS)
    rows = {"accuracy": estimators.accuracy_rows(groups), "steps": estimators.step_rows(steps)}
    values: dict[str, float | None] = {
        f"{name}_freq_rmse_over_crlb": accuracy.worst_ratio(some, accuracy.GATED_SNRS_dB)
        for name, some in groups.items()
    }
    try:
        require_emulator()
        costs = estimators.compare_ticks(Bench(), QUICK_TICKS if quick else TICKS)
    except UsageError as error:
        print(f"papers: instructions of a tick: {error}", file=sys.stderr)
    else:
        rows["ticks"] = estimators.tick_rows(costs)
        for name, some in costs.items():
            values[f"{name}_worst_tick_over_median"] = max(map(estimators.worst_over_median, some))
    return Measured(values, rows, tuple(estimators.tables(rows)))
