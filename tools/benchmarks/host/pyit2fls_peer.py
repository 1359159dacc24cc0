"""A peer of the fuzzy engine: PyIT2FLS evaluates Sugeno systems of interval type-2 sets by Nie and
Tan's method.

Runs in the peers' own environment (tools/benchmarks/fetch_peers python), as a program of its own:

    pyit2fls_peer.py < JOBS > DONE

JOBS: a JSON list of {"inputs": [[set]], "rules": [{"sets": [index of each input], "values":
[slopes and constant]}], "is_product", "points": FILE.npy [point][input], "out": FILE.npy [point]}.
A set: {"upper": end, "lower": end}; an end: {"word": "trimf" or "gaussmf", "numbers", "height"}, as
FIS has them. DONE is a JSON list with null for each job.
"""

import json
import sys
from typing import Any

import numpy as np
from pyit2fls import (
    IT2FS,
    IT2TSK,
    NT_algorithm,
    gaussian_mf,
    max_s_norm,
    min_t_norm,
    product_t_norm,
    tri_mf,
)


def nie_tan(intervals: np.ndarray) -> tuple[float, float]:
    """As the other methods answer: two ends."""
    value = float(NT_algorithm(intervals))
    return value, value


def end(description: dict[str, Any]) -> tuple[Any, list[float]]:
    numbers, height = description["numbers"], description["height"]
    if description["word"] == "gaussmf":
        deviation, mean = numbers
        return gaussian_mf, [mean, deviation, height]
    return tri_mf, [*numbers, height]


def fuzzy_set(description: dict[str, Any]) -> IT2FS:
    upper, lower = end(description["upper"]), end(description["lower"])
    return IT2FS(np.array([0.0, 1.0]), *upper, *lower)


def system(job: dict[str, Any]) -> IT2TSK:
    made = IT2TSK(product_t_norm if job["is_product"] else min_t_norm, max_s_norm)
    made.algorithm = nie_tan
    names = [f"x{i}" for i in range(len(job["inputs"]))]
    sets = [[fuzzy_set(one) for one in each] for each in job["inputs"]]
    for name in names:
        made.add_input_variable(name)
    made.add_output_variable("y")
    for rule in job["rules"]:
        conditions = [(name, sets[i][rule["sets"][i]]) for i, name in enumerate(names)]
        values = dict(zip([*names, "const"], rule["values"], strict=True))
        made.add_rule(conditions, [("y", values)])
    return made


def run(job: dict[str, Any]) -> None:
    made = system(job)
    points = np.load(job["points"])
    names = made.inputs
    values = [made.evaluate(dict(zip(names, map(float, one), strict=True)))["y"] for one in points]
    np.save(job["out"], np.array(values, dtype=float))


def main() -> None:
    jobs = json.load(sys.stdin)
    for job in jobs:
        run(job)
    json.dump([None] * len(jobs), sys.stdout)


main()
