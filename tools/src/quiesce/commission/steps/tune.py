"""Pulses for the plant, what they promise, and the best that any current could do."""

import os
from typing import Any

from quiesce.base.paths import shown
from quiesce.commission.work import DESIGNED, TUNED, Work
from quiesce.plant.library import Plant
from quiesce.tune.law import Row
from quiesce.tune.plan import Band, chosen_settings
from quiesce.tune.run import Order, Source, tune

NAME = "tune"
TITLE = "tune"
# Of the first mode: where what a law does shows most.
VERIFIED_PARTS = (0.87, 1.0, 1.3)
# By which of its bounds a setting is judged.
BOUND_OF = {"displacement": "amp", "balanced": "no_worse"}


def run(work: Work) -> dict[str, Any]:
    plant = work.path / DESIGNED
    setting = work.wants.setting
    order = Order(
        source=Source(plant, None, None, 1.0, True, None),
        out=work.path / TUNED,
        asked=f"quiesce tune {shown(plant)}",
        band=Band(),
        settings=chosen_settings([], []),
        robustness="none",
        is_quick=work.wants.is_quick,
        is_fresh=is_of_another_plant(work),
        has_closed_loop=False,
        jobs=os.cpu_count() or 1,
    )
    tuned = tune(order).tuned
    rows = verified_rows(tuned.rows, Plant(plant).modes[0].freq_Hz)
    parameters = {**tuned.parameters, "phase_setting": setting}
    return {"parameters": parameters, "predicted": [predicted(row, setting) for row in rows]}


def is_of_another_plant(work: Work) -> bool:
    """Pieces that an earlier design left are of no use."""
    work_file, plant = work.path / TUNED / "work.json", work.path / DESIGNED
    return work_file.is_file() and work_file.stat().st_mtime < plant.stat().st_mtime


def verified_rows(rows: list[Row], first_Hz: float) -> list[Row]:
    """Those of the table's frequencies that are next to the parts of the first mode's."""
    known = [row for row in rows if row.bounds]
    nearest = [
        min(known, key=lambda row: abs(row.freq_Hz - part * first_Hz)) for part in VERIFIED_PARTS
    ]
    return sorted({row.freq_Hz: row for row in nearest}.values(), key=lambda row: row.freq_Hz)


def predicted(row: Row, setting: str) -> dict[str, float | None]:
    """Reductions in %."""
    assert row.bounds is not None
    bound, pulse = row.bounds[BOUND_OF[setting]], row.settings[setting]
    return {
        "freq_Hz": row.freq_Hz,
        "bound_pct": bound["amp_red_pct"],
        "predicted_pct": pulse["amp_red_pct"] if pulse else None,
        "predicted_accel_pct": pulse["accel_red_pct"] if pulse else None,
    }


def line(result: dict[str, Any]) -> str:
    def pct(value: float | None) -> str:
        return "-" if value is None else f"{value:.1f}"

    return "; ".join(
        f"{one['freq_Hz']:.3g} Hz {pct(one['predicted_pct'])} % of {pct(one['bound_pct'])} %"
        for one in result["predicted"]
    )
