"""Random Sugeno systems of interval type-2 sets, as T2FIS files: our integers beside PyIT2FLS,
which computes Nie and Tan's method on its own."""

import itertools
import json
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from quiesce.base.paths import root
from quiesce.rules.engine.precise import WEAKEST, compile_precisely
from quiesce.rules.engine.system_engine import SystemEngine
from quiesce.rules.formats.files import read_system
from quiesce.rules.system.reference import evaluate

from quiesce_benchmarks.fuzzy.peers import PYTHON, built_peer, run_program

SYSTEMS = 15
POINTS = 200
SYSTEM_SECTION = """[System]
Name='random'
Type='sugeno'
AndMethod='{conjunction}'
OrMethod='probor'
DefuzzMethod='wtaver'
TypeRedMethod='NT'
"""


@dataclass(frozen=True)
class Drawn:
    """A system as the peer takes it, and as a file."""

    told: dict[str, Any]
    text: str


@dataclass(frozen=True)
class Type2Result:
    systems: int
    points: int  # that were judged
    worst_error_pct: float  # of the output's range, beside PyIT2FLS

    def line(self) -> str:
        return (
            f"type-2 rules: {self.systems} random systems, {self.points} points, within "
            f"{self.worst_error_pct:.2g} % of the range of PyIT2FLS"
        )


def draw(seed: int) -> Drawn:
    rng = np.random.default_rng(seed)
    inputs = [draw_sets(rng) for _ in range(rng.integers(2, 4))]
    rules = [
        {"sets": list(places), "values": np.round(rng.uniform(-1, 1, len(inputs) + 1), 3).tolist()}
        for places in itertools.product(*(range(len(sets)) for sets in inputs))
    ]
    if rng.random() < 0.5:
        for rule in rules:
            rule["values"][:-1] = [0.0] * len(inputs)
    told = {"inputs": inputs, "rules": rules, "is_product": bool(rng.random() < 0.5)}
    return Drawn(told, text_of(told))


def draw_sets(rng: np.random.Generator) -> list[dict[str, Any]]:
    """Two to four sets over -1 .. 1: triangles from neighbour to neighbour, or Gaussians."""
    count = int(rng.integers(2, 5))
    centres, step = np.linspace(-1, 1, count), 2.0 / (count - 1)
    make = triangles if rng.random() < 0.5 else gaussians
    return [make(rng, float(centre), step) for centre in centres]


def triangles(rng: np.random.Generator, centre: float, step: float) -> dict[str, Any]:
    def end(reach: float, height: float) -> dict[str, Any]:
        numbers = [centre - reach * step, centre, centre + reach * step]
        return {"word": "trimf", "numbers": [round(x, 4) for x in numbers], "height": height}

    return {
        "upper": end(1.1, 1.0),
        "lower": end(rng.uniform(0.4, 1.0), round(rng.uniform(0.3, 1.0), 3)),
    }


def gaussians(rng: np.random.Generator, centre: float, step: float) -> dict[str, Any]:
    def end(width: float, height: float) -> dict[str, Any]:
        numbers = [round(width * step, 4), round(centre, 4)]
        return {"word": "gaussmf", "numbers": numbers, "height": height}

    return {
        "upper": end(0.5, 1.0),
        "lower": end(rng.uniform(0.2, 0.5), round(rng.uniform(0.3, 1.0), 3)),
    }


def text_of(told: dict[str, Any]) -> str:
    conjunction = "prod" if told["is_product"] else "min"
    parts = [SYSTEM_SECTION.format(conjunction=conjunction)]
    for number, sets in enumerate(told["inputs"], start=1):
        lines = [f"[Input{number}]", f"Name='x{number}'", "Range=[-1 1]"]
        for k, one in enumerate(sets, start=1):
            for side, end in (("U", one["upper"]), ("L", one["lower"])):
                numbers = vector([*end["numbers"], end["height"]])
                lines.append(f"MF{k}{side}='s{k}{side}':'{end['word']}',{numbers}")
        parts.append("\n".join(lines))
    values = [rule["values"] for rule in told["rules"]]
    terms = [f"MF{k}='t{k}':'linear',{vector(one)}" for k, one in enumerate(values, start=1)]
    parts.append("\n".join(["[Output1]", "Name='y'", "Range=[-4 4]", *terms]))
    rows = [
        f"{' '.join(str(place + 1) for place in rule['sets'])}, {k} (1) : 1"
        for k, rule in enumerate(told["rules"], start=1)
    ]
    return "\n\n".join([*parts, "\n".join(["[Rules]", *rows])]) + "\n"


def vector(values: Sequence[float]) -> str:
    return "[" + " ".join(repr(value) for value in values) + "]"


def pyit2fls(jobs: Sequence[dict[str, Any]], points: Sequence[np.ndarray]) -> list[np.ndarray]:
    """points: [point, input] of each job. [point] of each."""
    program = [built_peer(PYTHON), "-I", root() / "tools/benchmarks/host/pyit2fls_peer.py"]
    with TemporaryDirectory() as name:
        orders = []
        for i, (job, x) in enumerate(zip(jobs, points, strict=True)):
            files = {key: str(Path(name) / f"{key}{i}.npy") for key in ("points", "out")}
            np.save(files["points"], x)
            orders.append({**job, **files})
        run_program(program, json.dumps(orders))
        return [np.load(one["out"]) for one in orders]


def measure_type2(seed: int, say: Callable[[str], None]) -> Type2Result:
    """UsageError where the peer cannot be had."""
    drawn = [draw(SYSTEMS * seed + number) for number in range(SYSTEMS)]
    made, counts, values = [], [], []
    rng = np.random.default_rng(seed)
    with TemporaryDirectory() as name:
        file = Path(name) / "random.t2fis"
        for one in drawn:
            file.write_text(one.text, encoding="utf-8")
            compiled = compile_precisely(read_system(file)).compiled
            axes = range(len(compiled.system.inputs))
            of_each = [compiled.input_integer(i, rng.uniform(-1, 1, POINTS)) for i in axes]
            made.append(compiled)
            counts.append(np.array(of_each))
            values.append(np.array([compiled.input_value(i, row) for i, row in enumerate(of_each)]))
    say("type-2 systems compiled")
    wanted = pyit2fls([one.told for one in drawn], [x.T for x in values])
    worst, judged = 0.0, 0
    for compiled, count, x, answer in zip(made, counts, values, wanted, strict=True):
        out, _ = SystemEngine(compiled).evaluate(count)
        output = compiled.system.outputs[0]
        is_judged = evaluate(compiled.system, list(x)).strongest[0] >= WEAKEST
        off = np.abs(compiled.output_value(0, out[0]) - answer)[is_judged]
        worst = max(worst, float(off.max(initial=0.0)) / (output.maximum - output.minimum))
        judged += int(is_judged.sum())
    return Type2Result(len(made), judged, 100.0 * worst)
