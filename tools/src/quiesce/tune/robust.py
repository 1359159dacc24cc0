"""How a law does on plants that it was not tuned for: its table alone, and adapting."""

import tempfile
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import tomli_w

from quiesce.engine.bench import Bench, setting_options
from quiesce.engine.pool import run_work
from quiesce.engine.trace import Trace, read_trace
from quiesce.plant.library import Plant
from quiesce.plant.variant import Variant
from quiesce.table.file import table_bytes
from quiesce.tune.law import setting_figures
from quiesce.tune.phase_table import SETTINGS, PhaseLaw
from quiesce.tune.phase_words import law_words
from quiesce.tune.plan import TunePlan
from quiesce.tune.store import TuneStore
from quiesce.tune.work import VariantWork, variant_plant

ADAPTED_s = 120.0
MEASURED_s = 2.0


@dataclass(frozen=True)
class Cell:
    """One plant at one frequency; reductions in % against 0 A on that plant."""

    variant: Variant
    freq_Hz: float
    bound: dict[str, float]
    constant: dict[str, float]  # the best one, with its current_A
    table: dict[str, dict[str, float] | None]  # by setting; None: does not come to rest
    adapted: dict[str, dict[str, float]]  # by setting; empty where no closed loop ran


class ClosedLoop:
    """The firmware with a law file, on a plant, in the bench."""

    def __init__(self, law: PhaseLaw, settings: list[str], folder: Path) -> None:
        """settings: NAME=VALUE. folder: for the law's table."""
        self.bench = Bench()
        table = folder / "law.table"
        table.write_bytes(table_bytes(law_words(law)))
        self._options = ["--pulses", str(table), *setting_options(settings)]

    def run(self, plant: Path, freq_Hz: float, duration_s: float, law: str, *more: str) -> Any:
        """The bench's figures over the last 2 s. more: options."""
        options = self._options if law == "phase" else []
        with tempfile.TemporaryDirectory(prefix="quiesce-") as folder:
            scenario = Path(folder) / "scenario.toml"
            scenario.write_text(sine_text(plant, freq_Hz, duration_s), encoding="utf-8")
            words = ["--scenario", str(scenario), "--law", law, *options, *more]
            return self.bench.json("run", *words)

    def trace(self, plant: Path, freq_Hz: float, duration_s: float, law: str, *more: str) -> Trace:
        with tempfile.TemporaryDirectory(prefix="quiesce-") as folder:
            file = Path(folder) / "trace"
            columns = "t_s,x5_um,coil_A,force_mN"
            more = (*more, "--trace", str(file), "--columns", columns)
            self.run(plant, freq_Hz, duration_s, law, *more)
            return read_trace(file)


def sine_text(plant: Path, freq_Hz: float, duration_s: float) -> str:
    """A scenario: one sine from rest."""
    return tomli_w.dumps(
        {
            "schema": "quiesce-scenario",
            "version": 1,
            "name": f"{freq_Hz:g} Hz",
            "plant": str(plant.resolve()),
            "duration_s": duration_s,
            "segment": [{"kind": "sine", "freq_Hz": freq_Hz}],
            "window": [{"start_s": duration_s - MEASURED_s, "end_s": duration_s}],
        }
    )


def cells(plan: TunePlan, store: TuneStore, law: PhaseLaw, loop: ClosedLoop | None) -> list[Cell]:
    """loop: None leaves the adapting firmware out."""
    pieces = [
        (
            f"closed loop {variant.name} {freq_Hz:g} Hz",
            partial(_cell, plan, store, law, loop, variant, freq_Hz),
        )
        for variant in plan.variants
        for freq_Hz in plan.shown_Hz
    ]
    return run_work(loop.bench if loop else None, pieces)


def _cell(
    plan: TunePlan,
    store: TuneStore,
    law: PhaseLaw,
    loop: ClosedLoop | None,
    variant: Variant,
    freq_Hz: float,
) -> Cell:
    known = store[VariantWork(plan.plant, variant, freq_Hz, plan.quality).key]
    with variant_plant(plan.plant, variant) as plant:
        table = setting_figures(plant, law, freq_Hz)
        names = SETTINGS if loop else ()
        adapted = {name: _adapted(loop, plant, freq_Hz, name, known) for name in names}
    found = [known["constant"], *(each for each in table.values() if each), *adapted.values()]
    best = max([known["bound"], *found], key=lambda one: one["amp_red_pct"])
    return Cell(variant, freq_Hz, best, known["constant"], table, adapted)


def _adapted(
    loop: ClosedLoop | None, plant: Plant, freq_Hz: float, setting: str, known: dict[str, Any]
) -> dict[str, float]:
    assert loop is not None
    options = setting_options([f"phase_setting={setting}", "adapt=on"])
    run = loop.run(plant.file, freq_Hz, ADAPTED_s, "phase", *options)
    return {
        "amp_red_pct": 100.0 * (1.0 - run["amp_um"] / known["amp_um"]),
        "accel_red_pct": 100.0 * (1.0 - run["accel_rms_mm_s2"] / known["accel_rms_mm_s2"]),
        "mean_current_A": run["mean_current_A"],
    }
