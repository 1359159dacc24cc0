"""What was promised against what is: each frequency without control and with it, as the controller
measures."""

import math
from typing import Any

import numpy as np

from quiesce.base.errors import BenchFailure
from quiesce.commission.samples import take
from quiesce.commission.site import heard
from quiesce.commission.work import Work

NAME = "verify"
TITLE = "verify against the prediction"
BEFORE, AFTER = "before.csv", "after.csv"
SETTLE_DECAYS, SETTLES_S = 5.0, (4.0, 30.0)
MEASURE_S, RECORD_S = 3.0, 5.0
NEAR = 0.03  # of the frequency: what the controller follows is what shakes
AMP, FREQ, VALID, RMS = (
    "motion/displacement_amp_nm", "motion/freq_uHz", "status/freq_is_valid", "status/rms_um_s2",
)  # fmt: skip


def run(work: Work) -> dict[str, Any]:
    points = work.result("tune")["predicted"]
    require_bound(points)
    strongest = max(points, key=lambda one: one["bound_pct"])["freq_Hz"]
    rows = []
    for one in points:
        work.tell(f"{one['freq_Hz']:.3g} Hz: without control, then with it")
        rows.append({**one, **compared(work, one["freq_Hz"], one["freq_Hz"] == strongest)})
    work.site.shake(points[0]["freq_Hz"], 0.0)
    return {"rows": rows, "share": share(rows), "recorded_Hz": strongest}


def require_bound(points: list[dict[str, Any]]) -> None:
    """BenchFailure where no current would take anything off: there is no share of nothing."""
    if sum(one["bound_pct"] for one in points) <= 0.0:
        raise BenchFailure(
            "no current takes anything off at the frequencies to verify (tuned/report.html): does "
            "the damper act on this mode?"
        )


def compared(work: Work, freq_Hz: float, is_recorded: bool) -> dict[str, float]:
    """Reductions in %, of the displacement's amplitude and the acceleration's RMS."""
    site = work.site
    site.shake(freq_Hz, work.result("excite")["drive_V"])
    before = steady(work, freq_Hz)
    if is_recorded:
        record(work, BEFORE)
    with site.armed(f"control at {freq_Hz:.3g} Hz"):
        after = steady(work, freq_Hz)
        if is_recorded:
            record(work, AFTER)
    return {
        "before_um": 1e-3 * before[AMP],
        "after_um": 1e-3 * after[AMP],
        "verified_pct": 100.0 * (1.0 - after[AMP] / before[AMP]),
        "verified_accel_pct": 100.0 * (1.0 - after[RMS] / before[RMS]),
    }


def steady(work: Work, freq_Hz: float) -> dict[str, float]:
    """Means. BenchFailure where the controller sees another frequency, or none."""
    found = work.result("find")
    decay_s = 1.0 / (2.0 * math.pi * found["modes_Hz"][0] * max(found["damping_ratios"][0], 1e-3))
    work.site.settle(min(max(SETTLE_DECAYS * decay_s, SETTLES_S[0]), SETTLES_S[1]))
    heard_now = heard(work.site, [AMP, FREQ, VALID, RMS], MEASURE_S)
    seen_Hz = 1e-6 * float(np.median(heard_now[FREQ]))
    if heard_now[VALID].mean() < 0.5 or abs(seen_Hz / freq_Hz - 1.0) > NEAR:
        raise BenchFailure(
            f"shaken at {freq_Hz:.4g} Hz the controller sees {seen_Hz:.4g} Hz, or is not sure: a "
            "stronger --drive? (track_min_accel_um_s2)"
        )
    means = {name: float(values.mean()) for name, values in heard_now.items()}
    if means[AMP] <= 0.0 or means[RMS] <= 0.0:
        raise BenchFailure(f"at {freq_Hz:.4g} Hz the controller measures no motion")
    return means


def record(work: Work, name: str) -> None:
    """Every sample, in m/s2, for the report of before and after."""
    rig = work.site.rig
    names = ("accel_scale_nm_s2", "accel_polarity", "accel_offset_counts")
    scale, polarity, offset = (int(rig.read(f"parameters/{one}")) for one in names)
    take(work.site, RECORD_S).write(work.path / name, 1e-9 * scale * polarity, offset)


def share(rows: list[dict[str, Any]]) -> float:
    """Of what the bound takes off at these frequencies, taken together."""
    return float(sum(one["verified_pct"] for one in rows) / sum(one["bound_pct"] for one in rows))


def line(result: dict[str, Any]) -> str:
    rows = "; ".join(
        f"{one['freq_Hz']:.3g} Hz {one['verified_pct']:.1f} %" for one in result["rows"]
    )
    return f"{rows}: {100 * result['share']:.0f} % of the bound"
