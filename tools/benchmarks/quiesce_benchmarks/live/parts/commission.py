"""`quiesce commission` on structures and dampers drawn at run, without a hand."""

import sys
import tempfile
from pathlib import Path
from typing import Any

from quiesce.base.errors import BenchFailure, UsageError, one_line
from quiesce.base.table import format_table
from quiesce.commission.run import Order, commission
from quiesce.commission.simulated import own_site
from quiesce.commission.steps.tune import BOUND_OF
from quiesce.commission.wants import Wants
from quiesce.tune.plan import FINE, QUICK
from quiesce.tune.work import BoundWork

from quiesce_benchmarks.live.drawn import Drawn, FREQ_Hz, MASS_kg, draw
from quiesce_benchmarks.part import Effort, Measured

TITLE = (
    f"commission: three structures and dampers drawn, {FREQ_Hz[0]:g} to {FREQ_Hz[1]:g} Hz, "
    f"{MASS_kg[0]:g} to {MASS_kg[1]:g} kg"
)
COUNT = 3
FIGURES = (
    ("commission_ok", "structures", float(COUNT), "higher"),
    ("commission_share", "1", 0.9, "higher"),
)
NEAR_PTS = 5.0  # from the prediction to what is verified
BAND_Hz = (0.8, 100.0)


def measure(effort: Effort) -> Measured:
    rows = []
    with tempfile.TemporaryDirectory() as scratch:
        for number in range(COUNT):
            rows.append(row_of(effort, number, Path(scratch) / str(number)))
    shares = [row["share"] for row in rows if row["share"] is not None]
    values: dict[str, float | None] = {
        "commission_ok": float(sum(row["why"] == "" for row in rows)),
        "commission_share": min(shares) if len(shares) == COUNT else None,
    }
    return Measured(values, {"rows": rows}, (table_of(rows),))


def row_of(effort: Effort, number: int, folder: Path) -> dict[str, Any]:
    """One structure, all steps; `why` it is not commissioned, empty: it is."""
    drawn = draw(effort.seed, number, folder)
    print(
        f"live: commission: {number + 1} of {COUNT}: {drawn.freq_Hz:.3g} Hz, "
        f"{drawn.mass_kg:.3g} kg",
        file=sys.stderr,
        flush=True,
    )
    row: dict[str, Any] = {
        "freq_Hz": drawn.freq_Hz, "mass_kg": drawn.mass_kg,
        "damper": "a file" if drawn.damper else "found", "share": None, "points": [],
    }  # fmt: skip
    try:
        verified = commissioned(drawn, folder / "rig", effort.is_quick)
        row |= judged(drawn, verified, effort.is_quick)
    except (BenchFailure, UsageError) as error:
        return {**row, "why": one_line(str(error))}
    # A pulse that was not predicted to come to rest has promised nothing.
    far = max(abs(one["verified_pct"] - (one["predicted_pct"] or 0.0)) for one in row["points"])
    return {**row, "why": "" if far <= NEAR_PTS else f"{far:.1f} points from the prediction"}


def commissioned(drawn: Drawn, folder: Path, is_quick: bool) -> list[dict[str, float]]:
    """What was verified at each frequency."""
    wants = Wants(
        plant=str(drawn.plant),
        start=drawn.start,
        base_plant=str(drawn.base),
        damper=str(drawn.damper) if drawn.damper else None,
        modal_mass_kg=drawn.mass_kg,
        band_Hz=BAND_Hz,
        is_quick=is_quick,
    )

    def tell(text: str) -> None:
        print(f"live: commission: {text}", file=sys.stderr, flush=True)

    done = commission(Order(folder, vars(wants), None, None, False), tell, own_site, tell)
    rows: list[dict[str, float]] = done.results["verify"]["rows"]
    return rows


def judged(drawn: Drawn, verified: list[dict[str, float]], is_quick: bool) -> dict[str, Any]:
    """Against the bound of the true plant, which the commissioning has never seen; what is verified
    raises a bound that was not found as high."""
    points = []
    for one in verified:
        work = BoundWork(drawn.plant, one["freq_Hz"], QUICK if is_quick else FINE)
        bound_pct = work.compute()["bounds"][BOUND_OF[Wants.setting]]["amp_red_pct"]
        points.append({**one, "own_bound_pct": max(bound_pct, one["verified_pct"])})
    own = sum(one["own_bound_pct"] for one in points)
    return {"points": points, "share": sum(one["verified_pct"] for one in points) / own}


def table_of(rows: list[dict[str, Any]]) -> str:
    cells = []
    for number, row in enumerate(rows, 1):
        head = [str(number), f"{row['freq_Hz']:.3g}", f"{row['mass_kg']:.3g}", row["damper"]]
        for one in row["points"]:
            cells.append(
                [
                    *head, f"{one['freq_Hz']:.3g}", f"{one['predicted_pct'] or 0.0:.1f}",
                    f"{one['verified_pct']:.1f}", f"{one['own_bound_pct']:.1f}", "",
                ]
            )  # fmt: skip
            head = [""] * 4
        share = "-" if row["share"] is None else f"{row['share']:.3f}"
        cells.append([*head, "", "", "share", share, row["why"] or "ok"])
    names = ["", "Hz", "kg", "damper", "at Hz", "predicted, %", "verified, %", "bound, %", ""]
    return format_table(names, cells, (0, 3, 8))
