"""Power cuts at every operation of the flash while records are saved."""

import re
import subprocess

from quiesce.base.errors import BenchFailure
from quiesce.base.paths import build_folder
from quiesce.engine.bench import ending, require_file

from quiesce_benchmarks.part import Effort, Measured

TITLE = "flash: the power goes at every word and erasure of a save"
FIGURES = (
    ("flash_cuts", "cuts", None, "higher"),
    ("flash_lost", "records", 0.0, "lower"),
)
TIMEOUT_s = 1800


def figures_of(printed: str) -> dict[str, float | None]:
    """Of what tests/unit/hal/test_nvm_cuts.c prints last."""
    found = {name: re.search(rf"^{name} (\d+)$", printed, re.M) for name, *_ in FIGURES}
    if not all(found.values()):
        raise BenchFailure("test_nvm_cuts did not tell its cuts")
    return {name: int(match[1]) for name, match in found.items() if match}


def measure(effort: Effort) -> Measured:
    program = require_file(build_folder() / "host/tests/unit/hal/test_nvm_cuts", "the test")
    done = subprocess.run([program], capture_output=True, text=True, timeout=TIMEOUT_s)
    values = figures_of(done.stdout)
    if done.returncode != 0 and not values["flash_lost"]:
        raise BenchFailure(f"test_nvm_cuts ended with {ending(done.returncode)}")
    return Measured(values)
