"""Coils beside controllers for a day of rest, of full drive and of bursts."""

from quiesce_benchmarks.trust.programs import run_all

HOURS, QUICK_HOURS = 24.0, 1.0  # of each kind


def measure(seed: int, quick: bool, jobs: int) -> dict[str, float]:
    """heat_above_s: how long coils are above their budget; heat_peak: of heat, as part of it."""
    hours = QUICK_HOURS if quick else HOURS
    parts = 1 if quick else jobs
    found = list(run_all([("heat", [seed + i, hours / parts]) for i in range(parts)], jobs))
    ticks = sum(one["ticks"] for one in found)
    all_hours = sum(one["hours"] for one in found)
    return {
        "heat_hours": all_hours,
        "heat_above_s": sum(one["above"] for one in found) * all_hours * 3 * 3600.0 / ticks,
        "heat_peak": max(one["peak"] for one in found),
        "heat_running_pct": 100.0 * sum(one["running"] for one in found) / ticks,
    }
