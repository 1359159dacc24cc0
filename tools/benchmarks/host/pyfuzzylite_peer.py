"""A peer of the fuzzy engine: pyfuzzylite evaluates rule bases at given points.

Runs in the peers' own environment (tools/benchmarks/fetch_peers python), as a program of its own:

    pyfuzzylite_peer.py < JOBS > DONE

JOBS: a JSON list of {"rules": FILE.fll, "points": FILE.npy [point][input], "out": FILE.npy
[point][output], "resolution": N or null}. Each result is written to its file; DONE is a JSON list
with null for a job that was done and a line of text for one that was refused.
"""

import json
import sys
from typing import Any

import fuzzylite as fl
import numpy as np

# Values that a centroid holds at a time: points times samples.
CHUNK_VALUES = 2_000_000


def read_engine(path: str, resolution: int | None) -> fl.Engine:
    engine = fl.FllImporter().from_file(path)
    for output in engine.output_variables:
        if resolution and isinstance(output.defuzzifier, fl.IntegralDefuzzifier):
            output.defuzzifier.resolution = resolution
    return engine


def evaluate(engine: fl.Engine, points: np.ndarray) -> np.ndarray:
    """[point][output]."""
    for variable, values in zip(engine.input_variables, points.T, strict=True):
        variable.value = values
    for output in engine.output_variables:
        output.clear()
    engine.process()
    outputs = [np.broadcast_to(o.value, len(points)) for o in engine.output_variables]
    return np.array(outputs, dtype=float).T


def run(job: dict[str, Any]) -> None:
    engine = read_engine(job["rules"], job["resolution"])
    points = np.load(job["points"])
    size = max(1, CHUNK_VALUES // (job["resolution"] or 8))
    parts = [evaluate(engine, points[i : i + size]) for i in range(0, len(points), size)]
    np.save(job["out"], np.concatenate(parts))


def answer(job: dict[str, Any]) -> str | None:
    try:
        run(job)
    except (ValueError, SyntaxError, TypeError, KeyError, RuntimeError, OSError) as error:
        return f"{type(error).__name__}: {error}"
    return None


if __name__ == "__main__":
    with np.errstate(all="ignore"):
        json.dump([answer(job) for job in json.load(sys.stdin)], sys.stdout)
