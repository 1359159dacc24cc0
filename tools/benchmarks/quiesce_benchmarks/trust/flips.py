"""Bits of a controller's memory flipped while it runs and while it is stopped."""

import sys
from collections import Counter

from quiesce_benchmarks.trust.programs import run_all

# Of one run of a program, with a seed of its own: rounds of scenes, random flips beside records.
SCENES = 1
RANDOM_FLIPS = 125_000
PARTS, QUICK_PARTS = 8, 2
# Of so many parts one is of a controller with many dampers.
MANY_EVERY = 4
UNSAFE = ("above_ceiling", "driver_on", "started")
WORST = ("record_ticks", "stop_ticks")


def calls(seed: int, quick: bool) -> list[tuple[str, list[object]]]:
    flips = RANDOM_FLIPS // 10 if quick else RANDOM_FLIPS
    return [
        (
            "flips_many" if number % MANY_EVERY == MANY_EVERY - 1 else "flips",
            [seed + number, SCENES, flips],
        )
        for number in range(QUICK_PARTS if quick else PARTS)
    ]


def measure(seed: int, quick: bool, jobs: int) -> dict[str, float]:
    """flips_tried, flips_unsafe, the reactions; how many a record's owner does not notice, and how
    many end the program: those command nothing any more."""
    total: Counter[str] = Counter()
    worst = dict.fromkeys(WORST, 0)
    for found in run_all(calls(seed, quick), jobs):
        first, seed_used = found.pop("first"), found.pop("seed")
        worst = {name: max(worst[name], found.pop(name)) for name in WORST}
        total.update(found)
        tried = found["in_records"] + found["elsewhere"]
        told = f", first {first}" if first else ""
        print(f"      seed {seed_used}: {tried} flips{told}", file=sys.stderr, flush=True)
    return {
        "reaction_ticks_worst_estop": worst["stop_ticks"],
        "reaction_ticks_worst_record": worst["record_ticks"],
        "flips_tried": total["in_records"] + total["elsewhere"],
        "flips_unsafe": total["unsafe"],
        "flips_in_records": total["in_records"],
        "flips_not_noticed": total["not_noticed"],
        "flips_crashed": total["crashed"],
        **{f"flips_{name}": total[name] for name in UNSAFE},
    }
