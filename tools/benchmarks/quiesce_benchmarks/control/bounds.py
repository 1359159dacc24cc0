"""The bounds of docs/results/bounds: every frequency of a sweep, and every plant of the robustness
figures. What the file already holds is not computed again.

    python -m quiesce_benchmarks.control.bounds OUT.json [--plant FILE] [--robustness]
"""

import argparse
import itertools
import os
from pathlib import Path

import numpy as np
from quiesce.base.paths import default_plant
from quiesce.optimum.store import GOALS, BoundStore, Case, compute_all
from quiesce.plant.variant import Variant

SWEEP_HZ = tuple(float(f) for f in np.arange(4.0, 22.01, 0.5))
ROBUST_HZ = (5.0, 10.0, 15.0, 20.0)
ROBUST_VARIANTS = tuple(
    Variant(rise_s=lag, force=force, freq=freq, drive_V=drive_V)
    for lag, force, drive_V, freq in itertools.product(
        (0.002, 0.005, 0.010), (0.7, 1.0, 1.5), (0.09, 0.12), (0.9, 1.0, 1.1)
    )
)


def nominal_cases(plant: Path) -> list[Case]:
    return [Case(plant, Variant(), freq, tuple(GOALS)) for freq in SWEEP_HZ]


def robust_cases(plant: Path) -> list[Case]:
    return [
        Case(plant, variant, freq, ("amp",))
        for variant, freq in itertools.product(ROBUST_VARIANTS, ROBUST_HZ)
    ]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("out", type=Path, metavar="OUT.json")
    parser.add_argument("--plant", type=Path, default=default_plant())
    parser.add_argument("--robustness", action="store_true", help="54 plants at 4 frequencies")
    parser.add_argument("--workers", type=int, default=os.cpu_count())
    args = parser.parse_args()
    cases = robust_cases(args.plant) if args.robustness else nominal_cases(args.plant)
    words = f"python -m quiesce_benchmarks.control.bounds docs/results/bounds/{args.out.name}"
    words += " --robustness" if args.robustness else ""
    compute_all(BoundStore(args.out, words), cases, args.workers)


if __name__ == "__main__":
    main()
