"""Bits of what a controller only reads (parameters, tables, program) flipped while it runs."""

from quiesce_benchmarks.trust.programs import run_all

# Of one run of a program, with a seed of its own.
FLIPS = 25_000
PARTS, QUICK_PARTS = 4, 1
# What flip_noticed_s says of a flip that is never noticed, s.
NEVER_S = 1e9


def measure(seed: int, quick: bool, jobs: int) -> dict[str, float]:
    """flip_noticed_s: longest time to the fault; flip_reaction_ticks: longest from there to drivers
    off without current. Those that end the program command nothing any more."""
    parts = QUICK_PARTS if quick else PARTS
    flips = FLIPS // 10 if quick else FLIPS
    found = list(run_all([("sweeps", [seed + i, flips]) for i in range(parts)], jobs))
    total = {name: sum(one[name] for one in found) for name in found[0]}
    worst = {name: max(one[name] for one in found) for name in ("longest_us", "reaction_ticks")}
    # One that ends the program after it was noticed counts for both.
    missed = max(total["not_noticed"], total["tried"] - total["noticed"] - total["crashed"])
    return {
        "flip_noticed_s": NEVER_S if missed else worst["longest_us"] / 1e6,
        "flip_reaction_ticks": worst["reaction_ticks"],
        "flips_swept": total["tried"],
        "flips_swept_missed": missed,
        "flips_swept_crashed": total["crashed"],
        "flips_swept_unsafe": total["above_ceiling"] + total["driver_on"],
    }
