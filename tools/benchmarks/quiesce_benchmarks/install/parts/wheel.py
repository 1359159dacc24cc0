"""The Python package in empty environments: an example of every command, outside of the tree."""

import tempfile
from pathlib import Path

from quiesce.base.errors import BenchFailure, UsageError
from quiesce.base.table import format_table

from quiesce_benchmarks.install.outside import run
from quiesce_benchmarks.install.package import NAMES, environment, made_wheel, verdicts
from quiesce_benchmarks.part import Effort, Measured

TITLE = "wheel: every command with an offline example, in an empty environment"
VERSIONS = ("3.11", "3.12", "3.13")
FIGURES = (
    ("wheel_commands_ok", "1", float(len(NAMES)), "higher"),
    ("wheel_pythons", "1", None, "higher"),
)


def pythons() -> dict[str, str]:
    """Those of VERSIONS that are here and make environments, by version."""
    found = {}
    for version in VERSIONS:
        kept = sorted(Path.home().glob(f".pyenv/versions/{version}.*/bin/python{version}"))
        for name in (f"python{version}", *map(str, kept)):
            try:
                run(name, "-I", "-c", "import ensurepip, venv")
            except (BenchFailure, UsageError):
                continue
            found[version] = name
            break
    return found


def measure(effort: Effort) -> Measured:
    wrong: dict[str, str] = {}
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for version, python in pythons().items():
            wheel = made_wheel(folder / f"made{version}", python)
            command = environment(folder / f"env{version}", wheel, python)
            work = folder / f"work{version}"
            work.mkdir()
            found = verdicts(command, work)
            wrong |= {
                key: f"{version}: {verdict}" for key, verdict in found.items() if verdict != "ok"
            }
    table = format_table(["command that failed", ""], [list(row) for row in wrong.items()])
    return Measured(
        {
            "wheel_commands_ok": float(len(NAMES) - len(wrong)),
            "wheel_pythons": float(len(pythons())),
        },
        {"wrong": wrong, "pythons": list(pythons())},
        (table,) if wrong else (),
    )
