"""Projects that are not ours, with Quiesce in them: built and run."""

import tempfile
from pathlib import Path

from quiesce.base.errors import BenchFailure
from quiesce.base.table import format_table

from quiesce_benchmarks.install.outside import PROJECTS
from quiesce_benchmarks.part import Effort, Measured

TITLE = "outside projects: built and run, with Quiesce in each"
FIGURES = (
    ("outside_projects_ok", "1", float(len(PROJECTS)), "higher"),
    ("outside_projects_of", "1", None, "higher"),
)


def _verdict(name: str, folder: Path) -> str:
    folder.mkdir()
    try:
        PROJECTS[name](folder)
    except BenchFailure as error:
        return str(error)
    return "ok"


def measure(effort: Effort) -> Measured:
    with tempfile.TemporaryDirectory() as folder:
        verdicts = {name: _verdict(name, Path(folder) / name) for name in PROJECTS}
    return Measured(
        {
            "outside_projects_ok": sum(verdict == "ok" for verdict in verdicts.values()),
            "outside_projects_of": len(verdicts),
        },
        {"projects": verdicts},
        (format_table(["project", ""], [list(row) for row in verdicts.items()], left=(0, 1)),),
    )
