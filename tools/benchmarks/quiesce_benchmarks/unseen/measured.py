"""The measured dampers' tests as they are in the files, before anything is filtered."""

from pathlib import Path
from typing import Any

from quiesce.damper.data.mapping import plan_of_mapping
from quiesce.damper.data.read import RawTest, read_file

from quiesce_benchmarks.damper.real import rules

# Beside those of scoring.toml.
MORE: tuple[dict[str, Any], ...] = (
    {
        "name": "utfsm_sine_3Hz",
        "file": "mr_damper/utfsm_raw_sine_5mm3hz.csv",
        "columns": {
            "time": "t_s",
            "displacement": "x_raw_mm",
            "force": "force_raw_n",
            "current": "current_a",
        },
        "group": ["current_a"],
    },
    {
        "name": "utfpr_table",
        "file": "mr_damper/utfpr_shaketable_16tests.csv",
        "columns": {
            "time": "t_s",
            "displacement": "x_raw_mm",
            "velocity": "v_mm_s",
            "force": "force_raw_n",
            "command": "coil_v_inferred:V",
        },
        "group": ["test_id"],
    },
)


def entries() -> list[dict[str, Any]]:
    """One for each file."""
    by_file = {one["file"]: one for one in [*rules()["set"], *MORE]}
    return list(by_file.values())


def measured_tests(folder: Path) -> list[RawTest]:
    """All tests of all files below `folder`."""
    found: list[RawTest] = []
    for entry in entries():
        plan = plan_of_mapping(entry, f"set {entry['name']}")
        found += read_file(folder / entry["file"], plan.columns).tests
    return found
