"""The report of a commissioning, one page."""

from typing import Any

from quiesce.commission.work import TUNED, Work
from quiesce.report.page import render

HEAD = [
    "Hz", "without control, um", "with control, um", "predicted, %", "verified, %", "best, %",
    "share of the best, %", "acceleration: predicted, %", "verified, %",
]  # fmt: skip


def page(work: Work, has_pair: bool) -> str:
    results = work.folder.results
    verified = results["verify"]
    return render(
        "commission/page.html.j2",
        title=work.path.resolve().name,
        cards=cards(verified),
        rows=(HEAD, [row_of(one) for one in verified["rows"]]),
        steps=(["step", "what came of it"], [list(one) for one in work.lines]),
        doubts=doubts(work),
        settings="\n".join(f"{name} = {one}" for name, one in work.folder.settings.items()),
        is_simulated=work.wants.plant is not None,
        has_pair=has_pair,
        tuned=f"{TUNED}/report.html",
    )  # fmt: skip


def cards(verified: dict[str, Any]) -> list[tuple[str, str, bool]]:
    rows = verified["rows"]
    best = max(rows, key=lambda one: one["verified_pct"])
    worst = max(rows, key=lambda one: abs(one["verified_pct"] - (one["predicted_pct"] or 0.0)))
    off_pts = worst["verified_pct"] - (worst["predicted_pct"] or 0.0)
    return [
        (f"{best['verified_pct']:.0f} %", f"off the displacement at {best['freq_Hz']:.3g} Hz",
         best["verified_pct"] <= 0.0),
        (f"{100 * verified['share']:.0f} %", "of what any current could take off", False),
        (f"{off_pts:+.1f} points", f"furthest from the prediction, at {worst['freq_Hz']:.3g} Hz",
         False),
    ]  # fmt: skip


def row_of(one: dict[str, Any]) -> list[str]:
    def pct(value: float | None) -> str:
        return "-" if value is None else f"{value:.1f}"

    part = one["verified_pct"] / one["bound_pct"] if one["bound_pct"] > 0.0 else None
    return [
        f"{one['freq_Hz']:.4g}",
        f"{one['before_um']:.1f}",
        f"{one['after_um']:.1f}",
        pct(one["predicted_pct"]),
        pct(one["verified_pct"]),
        pct(one["bound_pct"]),
        "-" if part is None else f"{100 * part:.0f}",
        pct(one["predicted_accel_pct"]),
        pct(one["verified_accel_pct"]),
    ]


def doubts(work: Work) -> list[str]:
    results = work.folder.results
    out = [str(one) for one in results["find"]["warnings"]]
    if int(work.folder.settings.get("safe_current_mA", 0)):
        out.append(
            f"Without control flows safe_current_mA, {work.folder.settings['safe_current_mA']} mA; "
            "what is predicted, and the bound, are against none."
        )
    if results["wiring"]["measured_mA"] is None:
        out.append("Nobody measures the coil's current: that it flows was seen by its effect only.")
    if not results["calibrate"]["is_turned"]:
        out.append("The accelerometer was not turned over: its scale is its data sheet's.")
    return out
