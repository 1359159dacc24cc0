"""Controllers under everything that can come in: ticks, and those in which a rule is broken."""

import sys
from collections import Counter

from quiesce_benchmarks.trust.programs import run_all

# What must hold, as host/trust/rules.h says it.
RULES = ("range", "slew", "safe", "driver", "stop", "latch", "arming")
TICKS, QUICK_TICKS, FULL_TICKS = 10**8, 10**6, 10**9
# Of one run of a program; each has a seed of its own.
PART_TICKS = 5 * 10**6
# Of so many parts one is of many sensors and dampers, and of messages.
MANY_EVERY = 4


def calls(ticks: int, seed: int) -> list[tuple[str, list[object]]]:
    part = min(PART_TICKS, ticks)
    return [
        (
            "abuse_many" if number % MANY_EVERY == MANY_EVERY - 1 else "abuse",
            [seed + number, part],
        )
        for number in range(max(MANY_EVERY, -(-ticks // part)))
    ]


def measure(ticks: int, seed: int, jobs: int) -> dict[str, float]:
    """abuse_ticks, abuse_violations, and what the controllers went through."""
    total: Counter[str] = Counter()
    for found in run_all(calls(ticks, seed), jobs):
        first = found.pop("first")
        seed_used = found.pop("seed")
        total.update(found)
        told = f", first {first}" if first else ""
        print(f"      seed {seed_used}: {found['ticks']} ticks{told}", file=sys.stderr, flush=True)
    return {
        "abuse_ticks": total["ticks"],
        "abuse_violations": sum(total[rule] for rule in RULES),
        "abuse_running_ticks": total["running_ticks"],
        "abuse_starts": total["starts"],
        "abuse_latched_faults": total["stops"],
    }
