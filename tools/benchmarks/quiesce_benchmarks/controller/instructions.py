"""Instructions of a control tick: of each law, of one more sensor, of one more damper."""

import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from quiesce.base.paths import build_folder
from quiesce.engine.bench import Bench, image, require_file
from quiesce.engine.scenarios import find_file, names, read_toml

from quiesce_benchmarks.controller.rigs import Board, Damper, Sensor, random_counts, write_rig

LAWS = ("off", "fuzzy", "fuzzy_selftune", "phase")
TICKS = 3000
SEED = 20261123


def plugin() -> str:
    return str(build_folder() / "host/sim_hil/icount_plugin.so")


def largest_image() -> str:
    """The one for eight sensors and four dampers."""
    built = build_folder() / "mps2/targets/mps2/quiesce_mps2_shm_8x4.elf"
    return str(require_file(built, "the image"))


def of_laws(bench: Bench, quick: bool) -> dict[str, tuple[int, int]]:
    """Median of the scenario with the largest, and worst tick, over the scenarios that ship for one
    sensor and one damper: those with a board need a larger image."""
    files = [find_file(name) for name in names()]
    scenarios = [file for file in files if "board" not in read_toml(file)]
    found = {}
    for law in LAWS:
        runs = [of_scenario(bench, law, file) for file in scenarios[:: 4 if quick else 1]]
        found[law] = (max(r["instr_median"] for r in runs), max(r["instr_worst"] for r in runs))
        print(f"controller: {law}: median {found[law][0]}, worst {found[law][1]}", file=sys.stderr)
    return found


def of_scenario(bench: Bench, law: str, scenario: Path) -> dict[str, Any]:
    target = ["--target", "mps2", "--image", str(image("mps2")), "--plugin", plugin()]
    run = ["--scenario", str(scenario), "--law", law, "--seeds", "1"]
    return bench.json("compare", *run, *target)


def accelerometers(bodies: Sequence[int]) -> list[Sensor]:
    return [Sensor("acceleration", i, 57.751) for i in bodies]


def strokes(dampers: Sequence[int]) -> list[Sensor]:
    return [Sensor("stroke", i, 10.0) for i in dampers]


def chain(dampers: int) -> list[Damper]:
    return [Damper(i, i - 1 if i else None) for i in range(dampers)]


def extra(bench: Bench) -> dict[str, float]:
    """What one more costs in a tick of law fuzzy on the largest build: the largest of the
    differences of medians and of worst ticks, of each kind of sensor."""
    one = of_board(bench, Board(4, accelerometers([0]), chain(4)))
    more = {
        "accelerometer": (Board(4, accelerometers(range(4)), chain(4)), 3),
        "stroke sensor": (Board(4, [*accelerometers([0]), *strokes(range(4))], chain(4)), 4),
    }
    sensors = [max(per_one(of_board(bench, board), one, count)) for board, count in more.values()]
    few = of_board(bench, Board(4, accelerometers([0]), chain(1)))
    dampers = per_one(one, few, 3)
    return {"sensor": max(sensors), "damper": max(dampers)}


def per_one(many: tuple[int, int], few: tuple[int, int], count: int) -> tuple[float, float]:
    return (many[0] - few[0]) / count, (many[1] - few[1]) / count


def of_board(bench: Bench, board: Board) -> tuple[int, int]:
    """Median and worst tick. The inputs of the first sensor are the same for all boards."""
    counts = np.hstack(
        [random_counts(np.random.default_rng([SEED, i]), 1, TICKS) for i in range(8)]
    )[:, : len(board.sensors)]
    with tempfile.TemporaryDirectory() as folder:
        rig = write_rig(Path(folder), board, counts)
        out = ["--trace", str(Path(folder) / "trace.bin"), "--every", str(TICKS)]
        target = ["--target", "mps2", "--image", largest_image(), "--plugin", plugin()]
        run = bench.json("replay", *rig, "--law", "fuzzy", *out, *target)
    return run["instr_median"], run["instr_worst"]
