"""The Python package in empty environments: an example of every command, outside of the tree."""

import tempfile
from pathlib import Path

from quiesce.base.errors import BenchFailure, UsageError
from quiesce.base.table import format_table

from quiesce_benchmarks.install.outside import run
from quiesce_benchmarks.install.package import (
    NAMES,
    bad_inputs,
    environment,
    made_wheel,
    verdicts,
)
from quiesce_benchmarks.part import Effort, Measured

TITLE = "wheel: every command with an offline example, in an empty environment"
VERSIONS = ("3.11", "3.12", "3.13")
FIGURES = (
    ("wheel_commands_ok", "1", float(len(NAMES)), "higher"),
    ("wheel_pythons", "1", None, "higher"),
    ("bad_inputs_wrong", "1", 0.0, "lower"),
    ("bad_inputs_ok", "1", 150.0, "higher"),
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
    """Quick: with one Python."""
    versions = dict(list(pythons().items())[: 1 if effort.is_quick else None])
    wrong: dict[str, str] = {}
    inputs: dict[str, str] = {}
    with tempfile.TemporaryDirectory() as name:
        for version, python in versions.items():
            folder = Path(name) / version
            work = folder / "work"
            work.mkdir(parents=True)
            command = environment(folder / "env", made_wheel(folder, python), python)
            found = verdicts(command, work)
            wrong |= {
                key: f"{version}: {verdict}" for key, verdict in found.items() if verdict != "ok"
            }
            inputs = inputs or bad_inputs(command, work)
    refused = {words: verdict for words, verdict in inputs.items() if verdict != "ok"}
    tables = [
        format_table([title, ""], [list(row) for row in rows.items()])
        for title, rows in (("command that failed", wrong), ("bad input", refused))
        if rows
    ]
    return Measured(
        {
            "wheel_commands_ok": float(len(NAMES) - len(wrong)),
            "wheel_pythons": float(len(versions)),
            "bad_inputs_wrong": float(len(refused)),
            "bad_inputs_ok": float(len(inputs) - len(refused)),
        },
        {"wrong": wrong, "refused": refused, "pythons": list(versions)},
        tuple(tables),
    )
