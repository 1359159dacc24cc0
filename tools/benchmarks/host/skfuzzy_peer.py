"""A peer of the fuzzy engine: scikit-fuzzy's control API evaluates Mamdani rule bases.

Runs in the peers' own environment (tools/benchmarks/fetch_peers python), as a program of its own:

    skfuzzy_peer.py < JOBS > DONE

JOBS: a JSON list of {"base": B, "points": FILE.npy [point][input], "out": FILE.npy [point],
"resolution": N}. B: {"inputs": [{"name", "minimum", "maximum", "sets": [{"name", "points"}]}],
"output": the same, "rules": [{"conditions": [[input, set, negated]], "is_or", "term", "weight"}]}.
The universes are sampled at N even steps and at every breakpoint. A point at which no rule fires
is NaN. DONE is a JSON list with null for a job that was done and a line of text for one that was
refused.
"""

import json
import sys
from functools import reduce
from typing import Any

import numpy as np
from skfuzzy import control


def variable(kind: type, description: dict[str, Any], resolution: int) -> Any:
    low, high = description["minimum"], description["maximum"]
    breaks = [x for one in description["sets"] for x, _ in one["points"] if low <= x <= high]
    universe = np.union1d(np.linspace(low, high, resolution + 1), breaks)
    made = kind(universe, description["name"])
    for one in description["sets"]:
        made[one["name"]] = np.interp(universe, *np.array(one["points"]).T)
    return made


def rule(inputs: list[Any], output: Any, description: dict[str, Any]) -> control.Rule:
    terms = []
    for index, name, is_negated in description["conditions"]:
        term = inputs[index][name]
        terms.append(~term if is_negated else term)
    joined = reduce((lambda a, b: a | b) if description["is_or"] else (lambda a, b: a & b), terms)
    return control.Rule(joined, output[description["term"]] % description["weight"])


def evaluate_one(system: control.ControlSystem, names: list[str], output: str, point: Any) -> float:
    simulation = control.ControlSystemSimulation(system, cache=False)
    for name, value in zip(names, point, strict=True):
        simulation.input[name] = float(value)
    simulation.compute()
    return float(simulation.output.get(output, np.nan))


def run(job: dict[str, Any]) -> None:
    base, resolution = job["base"], job["resolution"]
    inputs = [variable(control.Antecedent, one, resolution) for one in base["inputs"]]
    output = variable(control.Consequent, base["output"], resolution)
    system = control.ControlSystem([rule(inputs, output, one) for one in base["rules"]])
    used = {index for one in base["rules"] for index, _, _ in one["conditions"]}
    names = [one["name"] for i, one in enumerate(base["inputs"]) if i in used]
    points = np.load(job["points"])[:, sorted(used)]
    values = [evaluate_one(system, names, base["output"]["name"], point) for point in points]
    np.save(job["out"], np.array(values))


def answer(job: dict[str, Any]) -> str | None:
    try:
        run(job)
    except (ValueError, AssertionError, TypeError, KeyError, RuntimeError, OSError) as error:
        return f"{type(error).__name__}: {' '.join(str(error).split())}"
    return None


if __name__ == "__main__":
    with np.errstate(all="ignore"):
        json.dump([answer(job) for job in json.load(sys.stdin)], sys.stdout)
