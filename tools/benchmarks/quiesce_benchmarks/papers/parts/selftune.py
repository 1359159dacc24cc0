"""Self-tuning of the squeeze-mode paper (Tables X and XI, Fig. 13), in each of its readings.

Table X is "for the fuzzy control at low frequency"; how low the paper does not say. The first
reading is the caption's: printed signs, at work below 7.5 Hz, halfway between the rules' sets at 5
and 10 Hz. Then it rests in the step of Table XI, and the rules' current is what acts there: at most
the 5 A of the driver, so constant 5 A stands beside it as what no gated reading exceeds.
"""

from statistics import mean
from typing import Any

from quiesce.base.table import format_table
from quiesce.engine.bench import Bench, setting_options
from quiesce.engine.laws import CONSTANT_BEST, LAWS, OPEN_LOOP, SELFTUNE_PUBLISHED, Law, find
from quiesce.engine.scenarios import load
from quiesce.hil.published import load_reference

from quiesce_benchmarks.part import Effort, Measured

TITLE = "self-tuning: both polarities, with and without the gate at 7.5 Hz"
FIGURES = (
    ("selftune_gated_10Hz_pct", "%", 22.9, "higher"),
    ("selftune_gated_20Hz_pct", "%", 26.4, "higher"),
)
GATED = "fuzzy_selftune_printed_gated"
READINGS = [law for law in LAWS if law.reading_of == SELFTUNE_PUBLISHED]
CEILING = Law("constant_5A", "constant 5 A", find(CONSTANT_BEST).bench_law,
              ("constant_current_mA=5000",))  # fmt: skip
# Figures of the bench by frequency: the step's two windows, and the case of Fig. 13.
STEP, STEADY = "step_10_20Hz", "sine_5Hz"
WINDOWS = {"10Hz": (STEP, 10.0, "amp_um"), "20Hz": (STEP, 20.0, "amp2_um"),
           "5Hz": (STEADY, 5.0, "amp_um")}  # fmt: skip
MORE_SEEDS, QUICK_MORE_SEEDS = 8, 2


def amplitudes_um(bench: Bench, law: Law, seed: int) -> dict[str, float]:
    """Half peak-to-peak displacement by window, as `quiesce hil --seed` measures it."""
    runs = {
        name: bench.json(
            "run", "--scenario", str(load(bench, name).file), "--law", law.bench_law,
            *setting_options(law.settings), "--seed", str(seed),
        )
        for name in (STEP, STEADY)
    }  # fmt: skip
    return {window: runs[name][key] for window, (name, _, key) in WINDOWS.items()}


def reductions_pct(bench: Bench, law: Law, seed: int) -> dict[str, float]:
    at_rest, found = (amplitudes_um(bench, one, seed) for one in (find(OPEN_LOOP), law))
    return {window: 100.0 * (1.0 - found[window] / at_rest[window]) for window in WINDOWS}


def published_pct() -> dict[str, float | None]:
    reference = load_reference()
    found = {
        window: reference.published_for(scenario, SELFTUNE_PUBLISHED, freq_Hz)
        for window, (scenario, freq_Hz, _) in WINDOWS.items()
    }
    return {window: case.low_pct if case else None for window, case in found.items()}


def table(published: dict[str, Any], readings: dict[str, dict[str, float]]) -> str:
    rows = [["published", *(f"{published[window]:.2f}" for window in WINDOWS)]]
    rows += [[name, *(f"{found[w]:.2f}" for w in WINDOWS)] for name, found in readings.items()]
    return format_table(["displacement reduced by, %", *WINDOWS], rows, left=(0,))


def measure(effort: Effort) -> Measured:
    bench = Bench()
    readings = {
        law.name: reductions_pct(bench, law, effort.seed)
        for law in (*READINGS, find("fuzzy"), CEILING)
    }
    gated = readings[GATED]
    count = QUICK_MORE_SEEDS if effort.is_quick else MORE_SEEDS
    others = [reductions_pct(bench, find(GATED), effort.seed + 1 + i) for i in range(count)]
    spread = {
        window: {"least": min(values), "mean": mean(values), "most": max(values)}
        for window in WINDOWS
        for values in [[gated[window], *(one[window] for one in others)]]
    }
    published = published_pct()
    return Measured(
        {f"selftune_gated_{window}_pct": gated[window] for window in ("10Hz", "20Hz")},
        {"published": published, "readings": readings, "gated_over_noise_seeds": spread},
        (table(published, readings),),
    )
