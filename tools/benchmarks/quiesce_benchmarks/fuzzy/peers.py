"""Peers of the fuzzy engine, each a program of its own: libfuzzylite, pyfuzzylite, scikit-fuzzy.

tools/benchmarks/fetch_peers fetches and builds them when one is first wanted. pyfuzzylite and
libfuzzylite are GPL: they are run, never imported or linked by the package.
"""

import json
import os
import subprocess
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from quiesce.base.errors import BenchFailure, UsageError, one_line
from quiesce.base.paths import build_folder, root, shown
from quiesce.engine.bench import ending
from quiesce.rules.model import CENTROID, OR, FuzzySet, Input, Output, Point, RuleBase

from quiesce_benchmarks.images import build

FUZZYLITE, COUNT, PYTHON, BROWSER = "fuzzylite", "count", "python", "browser"
FILES = {
    FUZZYLITE: "host/tools/benchmarks/host/fuzzylite_peer",
    COUNT: "host/tools/benchmarks/host/call_points",
    PYTHON: "deps/peers/bin/python",
    BROWSER: "deps/axe/axe.min.js",
}


def built_peer(name: str) -> Path:
    """A program of FILES, up to date. With QUIESCE_BUILD set: as it is there.

    UsageError where it cannot be had: the network, a tool.
    """
    if not os.environ.get("QUIESCE_BUILD"):
        build("tools/benchmarks/fetch_peers", name)
    path = build_folder() / FILES[name]
    if not path.is_file():
        raise UsageError(f"{shown(path)} is missing; run ./tools/benchmarks/fetch_peers {name}")
    return path


@dataclass(frozen=True)
class Job:
    """A base to evaluate: as the text of an FLL file, or, for scikit-fuzzy, as it is."""

    rules: str | RuleBase
    points: np.ndarray  # [point, input]
    resolution: int | None = None  # samples of a centroid; None: as the file says


# What a job gave: [point, output], or one line why the peer refused it.
Answer = np.ndarray | str


def run_program(command: Sequence[str | Path], text: str = "") -> str:
    done = subprocess.run(list(map(str, command)), input=text, capture_output=True, text=True)
    if done.returncode == 2:
        raise UsageError(one_line(done.stderr))
    if done.returncode != 0:
        last = one_line(done.stderr.strip().splitlines()[-1:] or "it said nothing")
        raise BenchFailure(f"{Path(command[0]).name} ended with {ending(done.returncode)}: {last}")
    return done.stdout


def fuzzylite(job: Job) -> np.ndarray:
    """libfuzzylite 6: weighted averages sum over rules, whatever the file says."""
    program = built_peer(FUZZYLITE)
    with TemporaryDirectory() as name:
        rules, points, out = (Path(name) / one for one in ("rules.fll", "points", "out"))
        rules.write_text(str(job.rules), encoding="utf-8")
        np.ascontiguousarray(job.points, dtype=float).tofile(points)
        run_program([program, rules, points, out, str(job.resolution or 0)])
        return np.fromfile(out).reshape(len(job.points), -1)


def python_peer(script: str, jobs: Sequence[Job]) -> list[Answer]:
    program = built_peer(PYTHON)
    with TemporaryDirectory() as name:
        orders = [order(Path(name), i, job) for i, job in enumerate(jobs)]
        command = [program, "-I", root() / "tools/benchmarks/host" / script]
        refusals = json.loads(run_program(command, json.dumps(orders)))
        return [
            np.load(one["out"]) if refusal is None else str(refusal)
            for one, refusal in zip(orders, refusals, strict=True)
        ]


def order(folder: Path, number: int, job: Job) -> dict[str, Any]:
    """A job as the peers' programs read it, its files in the folder."""
    points, out = folder / f"points{number}.npy", folder / f"out{number}.npy"
    np.save(points, job.points)
    told: dict[str, Any] = {"points": str(points), "out": str(out), "resolution": job.resolution}
    if isinstance(job.rules, RuleBase):
        return {**told, "base": description(job.rules)}
    rules = folder / f"rules{number}.fll"
    rules.write_text(job.rules, encoding="utf-8")
    return {**told, "rules": str(rules)}


def pyfuzzylite(jobs: Sequence[Job]) -> list[Answer]:
    """pyfuzzylite 8: the file's aggregation, none (sum) or maximum."""
    return python_peer("pyfuzzylite_peer.py", jobs)


def skfuzzy(jobs: Sequence[Job]) -> list[Answer]:
    """scikit-fuzzy: bases that skfuzzy_holds."""
    return python_peer("skfuzzy_peer.py", jobs)


def skfuzzy_holds(base: RuleBase) -> str:
    """Empty, or why scikit-fuzzy cannot hold the base."""
    if len(base.outputs) != 1 or base.outputs[0].method != CENTROID:
        return "not one centroid"
    output = base.outputs[0]
    variables = [*((v, v.sets) for v in base.inputs), (output, output.terms)]
    shapes = [inner_points(one, v.minimum, v.maximum) for v, sets in variables for one in sets]
    if any(a[0] == b[0] for shape in shapes for a, b in zip(shape, shape[1:], strict=False)):
        return "vertical edges, between samples of its universes"
    return ""


def inner_points(fuzzy_set: FuzzySet, low: float, high: float) -> tuple[Point, ...]:
    """Without the feet of vertical edges that stand on the universe's ends or beyond."""
    points = fuzzy_set.points
    if len(points) > 1 and points[0][0] == points[1][0] <= low:
        points = points[1:]
    if len(points) > 1 and points[-1][0] == points[-2][0] >= high:
        points = points[:-1]
    return points


def variable(item: Input | Output, sets: Sequence[FuzzySet]) -> dict[str, Any]:
    low, high = item.minimum, item.maximum
    shapes = [{"name": one.name, "points": inner_points(one, low, high)} for one in sets]
    return {"name": item.name, "minimum": low, "maximum": high, "sets": shapes}


def description(base: RuleBase) -> dict[str, Any]:
    """Of a base that skfuzzy_holds, as its program reads it."""
    output = base.outputs[0]
    rules = [
        {
            "conditions": [
                [c.input, base.inputs[c.input].sets[c.set].name, c.negated] for c in rule.conditions
            ],
            "is_or": rule.connective == OR,
            "term": output.terms[rule.conclusions[0]].name,
            "weight": rule.weight,
        }
        for rule in base.rules
        if rule.conclusions[0] is not None
    ]
    return {
        "inputs": [variable(one, one.sets) for one in base.inputs],
        "output": variable(output, output.terms),
        "rules": rules,
    }
