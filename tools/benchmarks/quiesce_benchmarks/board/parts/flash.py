"""Power cuts at every operation of the flash: of saves, and of updates of the image."""

import re
import subprocess

from quiesce.base.errors import BenchFailure
from quiesce.base.paths import build_folder
from quiesce.engine.bench import ending, require_file

from quiesce_benchmarks.part import Effort, Measured

TITLE = "flash: the power goes at every word and erasure of a save and of an update"
FIGURES = (
    ("flash_cuts", "cuts", None, "higher"),
    ("flash_lost", "records", 0.0, "lower"),  # or images
)
# Of tests/unit/hal.
PROGRAMS = ("test_nvm_cuts", "test_slots")
TIMEOUT_s = 1800


def figures_of(program: str, printed: str) -> dict[str, int]:
    """Of what it prints last."""
    found = {name: re.search(rf"^{name} (\d+)$", printed, re.M) for name, *_ in FIGURES}
    if not all(found.values()):
        raise BenchFailure(f"{program} did not tell its cuts")
    return {name: int(match[1]) for name, match in found.items() if match}


def measure(effort: Effort) -> Measured:
    every = [figures_by(program) for program in PROGRAMS]
    return Measured({name: float(sum(one[name] for one in every)) for name, *_ in FIGURES})


def figures_by(name: str) -> dict[str, int]:
    program = require_file(build_folder() / "host/tests/unit/hal" / name, "the test")
    done = subprocess.run([program], capture_output=True, text=True, timeout=TIMEOUT_s)
    values = figures_of(name, done.stdout)
    if done.returncode != 0 and not values["flash_lost"]:
        raise BenchFailure(f"{name} ended with {ending(done.returncode)}")
    return values
