"""The frame sender of quiesced on a line with half of the rate that all of its frames need."""

import json
import subprocess
import tempfile
from pathlib import Path

from quiesce.base.errors import BenchFailure
from quiesce.base.paths import build_folder
from quiesce.engine.bench import require_file

PROGRAM = "host/tests/unit/linux/test_quiesced"
TEST = "FrameSender.half_a_line_loses_no_demand_and_answers_all"


def measure() -> dict[str, float]:
    """congested_replies_pct: answered within a second. congested_demand_lost: gaps beyond the
    driver's timeout of 10 ms; a demand of the same state that the next one has replaced within 4 ms
    is not lost, and counted as congested_demand_replaced."""
    program = require_file(build_folder() / PROGRAM, "the tests of quiesced")
    with tempfile.TemporaryDirectory() as folder:
        found = Path(folder) / "found.json"
        command = [str(program), f"--gtest_filter={TEST}", f"--gtest_output=json:{found}"]
        done = subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, text=True)
        if not found.is_file():
            raise BenchFailure(f"{TEST} left nothing behind, exit code {done.returncode}")
        case = json.loads(found.read_text())["testsuites"][0]["testsuite"][0]
    value = {key: float(word) for key, word in case.items() if key.startswith("congested_")}
    return {
        "congested_replies_pct": 100.0 * value["congested_answered"] / value["congested_replies"],
        "congested_demand_lost": value["congested_demand_lost"],
        "congested_demand_replaced": value["congested_demand_replaced"],
    }
