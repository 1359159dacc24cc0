"""How long a user waits: the first model, the default ones, a first look at a tuning."""

import os
import resource
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

from quiesce.base.errors import BenchFailure
from quiesce.base.paths import root
from quiesce.base.table import format_table
from quiesce.damper.example import Recipe, write_example

from quiesce_benchmarks.part import Effort, Measured

TITLE = "seconds until the first model, all default models, a quick tuning"
# Times are judged, and fail no check: they are of two idle cores.
FIGURES = (
    ("identify_first_s", "s", 10.0, "lower", False),
    ("identify_default_s", "s", 60.0, "lower", False),
    ("tune_quick_s", "s", 60.0, "lower", False),
)
# 9,000 rows at the example's rate.
SECONDS = 45.0
PLANTS = ("squeeze_2012", "suspended_mass", "single_mass", "two_storeys", "quarter_car")
_LOOK_s = 0.05


@dataclass(frozen=True)
class Took:
    """Wall and processor seconds of a command; first_s until its file was there."""

    wall_s: float
    cpu_s: float
    first_s: float | None = None


def measure(effort: Effort) -> Measured:
    """--quick: a fifth of the rows, and the first plant alone."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        write_example(
            folder / "rig.csv", Recipe(duration_s=SECONDS / (5 if effort.is_quick else 1))
        )
        words = ["identify", str(folder / "rig.csv"), "--out", str(folder / "out")]
        identified = took(words, folder / "out/damper.toml")
        plants = PLANTS[:1] if effort.is_quick else PLANTS
        tuned = {plant: tune(plant, folder / plant) for plant in plants}
    rows = [["identify", identified], *tuned.items()]
    table = format_table(
        ["command", "wall s", "processor s", "first model s"],
        [
            [
                name,
                f"{one.wall_s:.1f}",
                f"{one.cpu_s:.1f}",
                "" if one.first_s is None else f"{one.first_s:.1f}",
            ]
            for name, one in rows
        ],
        left=(0,),
    )
    values = {
        "identify_first_s": identified.first_s,
        "identify_default_s": identified.wall_s,
        "tune_quick_s": max(one.wall_s for one in tuned.values()),
    }
    cpu = {"identify_cpu_s": identified.cpu_s, "tune_cpu_s": {k: t.cpu_s for k, t in tuned.items()}}
    return Measured(values, cpu, (table,))


def tune(plant: str, out: Path) -> Took:
    file = root() / f"sim_hil/data/plants/{plant}.toml"
    return took(["tune", str(file), "--quick", "--out", str(out)])


def took(words: list[str], file: Path | None = None) -> Took:
    """`quiesce WORDS`, and how long it took until `file` was there. BenchFailure with its last line
    where it fails."""
    before = cpu_of_children_s()
    start_s = time.monotonic()
    first_s = None
    with tempfile.TemporaryFile("w+") as log:
        process = subprocess.Popen(
            [sys.executable, "-m", "quiesce", *words],
            stdout=subprocess.DEVNULL,
            stderr=log,
            env={**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path))},
        )
        while process.poll() is None:
            if first_s is None and file is not None and file.is_file():
                first_s = time.monotonic() - start_s
            time.sleep(_LOOK_s)
        wall_s = time.monotonic() - start_s
        if process.returncode != 0:
            log.seek(0)
            last = (log.read().strip().splitlines() or ["no message"])[-1]
            raise BenchFailure(f"quiesce {words[0]}: {last}")
    return Took(wall_s, cpu_of_children_s() - before, first_s)


def cpu_of_children_s() -> float:
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime
