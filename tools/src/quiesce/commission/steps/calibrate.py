"""The accelerometer by gravity: turned over it reads +1 g and -1 g, which tells axis, sign, gain
and offset; shaken at one frequency, whether it sits fast."""

from typing import Any

from quiesce.base.errors import BenchFailure
from quiesce.commission.samples import Samples, take
from quiesce.commission.work import Work

NAME = "calibrate"
TITLE = "the accelerometer: axis, offset, gain, mounting"
G_nm_s2 = 9.80665e9
UP = "take the accelerometer off and lay it on a level table, its arrow up"
DOWN = "turn it over: its arrow down"
BACK = "mount it again, its arrow along the structure's positive direction"
HOLD_S, SETTLE_S = 2.0, 1.0
LEAST_PART = 0.1  # of the 2 g that another axis, or a sensor without DC, does not show
MOST_MOVED = 0.05  # of 1 g, RMS while it lies still
LOOSE_PART = 0.5  # of the power away from the shaker's frequency
SCALES_nm_s2 = (1, 1_000_000_000)


def run(work: Work) -> dict[str, Any]:
    turned = {} if work.wants.is_as_mounted else turned_over(work)
    mounting = mounted(work)
    return {"is_turned": bool(turned), **turned, "power_at_drive": mounting}


def turned_over(work: Work) -> dict[str, Any]:
    """BenchFailure where it shows no gravity."""
    site, rig = work.site, work.site.rig
    site.shake(work.trial_Hz, 0.0)
    site.turn(1.0, UP)
    up = held(work)
    site.turn(-1.0, DOWN)
    down = held(work)
    site.turn(0.0, BACK)
    before_nm_s2 = int(rig.read("parameters/accel_scale_nm_s2"))
    settings = from_gravity(up, down, before_nm_s2)
    work.give(settings)
    return {
        "up_counts": up.mean,
        "down_counts": down.mean,
        "scale_before_nm_s2": before_nm_s2,
        **settings,
    }


def held(work: Work) -> Samples:
    work.site.settle(SETTLE_S)
    return take(work.site, HOLD_S)


def from_gravity(up: Samples, down: Samples, before_nm_s2: int) -> dict[str, int | str]:
    """Parameters of the controller. Half of the difference is 1 g, half of the sum the offset."""
    half = 0.5 * (up.mean - down.mean)
    seen = abs(half) * before_nm_s2 / G_nm_s2
    if seen < LEAST_PART:
        raise BenchFailure(
            f"turned over it shows {seen:.2f} g in place of 1: another axis (accel_axis), or a "
            "sensor that shows no gravity; for that one --as-mounted"
        )
    if max(up.noise, down.noise) > MOST_MOVED * abs(half):
        raise BenchFailure("it moved while it was measured; lay it down and try again")
    scale_nm_s2 = round(G_nm_s2 / abs(half))
    if not SCALES_nm_s2[0] <= scale_nm_s2 <= SCALES_nm_s2[1]:
        raise BenchFailure(f"{scale_nm_s2} nm/s2 a count: the controller takes 1 .. 1e9")
    return {
        "accel_scale_nm_s2": scale_nm_s2,
        "accel_offset_counts": round(0.5 * (up.mean + down.mean)),
        "accel_polarity": 1 if half > 0.0 else -1,
    }


def mounted(work: Work) -> float:
    """Part of the power that is at the shaker's frequency: what rattles has others."""
    site = work.site
    site.shake(work.trial_Hz, work.drive_V)
    site.settle(HOLD_S)
    part = take(site, HOLD_S).power_at(work.trial_Hz)
    site.shake(work.trial_Hz, 0.0)
    if part < LOOSE_PART:
        work.tell(
            f"only {100 * part:.0f} % of the power is at the shaker's {work.trial_Hz:g} Hz: does "
            "the accelerometer sit fast?"
        )
    return part


def line(result: dict[str, Any]) -> str:
    fast = f"{100 * result['power_at_drive']:.0f} % of the power at the shaker's frequency"
    if not result["is_turned"]:
        return f"as mounted, not turned over; {fast}"
    off_pct = 100 * (result["accel_scale_nm_s2"] / result["scale_before_nm_s2"] - 1.0)
    return (
        f"{result['accel_scale_nm_s2']} nm/s2 a count ({off_pct:+.2f} %), offset "
        f"{result['accel_offset_counts']} counts, polarity {result['accel_polarity']:+d}; {fast}"
    )
