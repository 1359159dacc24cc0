"""The Python package in an empty environment, and its commands there."""

import json
import os
import shlex
import subprocess
import sys
from pathlib import Path

from quiesce.base.errors import EXIT_BAD_INPUT, BenchFailure
from quiesce.base.paths import root

from quiesce_benchmarks.install.examples import EXAMPLES, EXTRAS, NEED_A_BUS, NO_BUS, write_files
from quiesce_benchmarks.install.outside import run

TIMEOUT_s = 600
BAD_INPUTS = Path(__file__).with_name("bad_inputs.py")
# What is judged: commands, and extras that are asked for.
NAMES = {name for name, _ in (*EXAMPLES, *NEED_A_BUS)} | {f"extra {one}" for one, _ in EXTRAS}


def made_wheel(folder: Path, python: str = sys.executable) -> Path:
    """Made for that Python by the project's own script, for processors like this one."""
    run(
        "env",
        f"QUIESCE_PYTHON={python}",
        root() / "tools/package",
        "--native",
        "--out",
        folder,
        "wheel",
    )
    return next((folder / "packages").glob("*.whl"))


def environment(folder: Path, wheel: Path, python: str = sys.executable) -> Path:
    """An empty environment with the wheel and what it depends on; the command `quiesce` of it."""
    run(python, "-I", "-m", "venv", folder)
    run(folder / "bin/python", "-I", "-m", "pip", "--no-input", "install", wheel)
    return folder / "bin/quiesce"


def typed(command: Path, words: str, folder: Path) -> subprocess.CompletedProcess[str]:
    """`quiesce WORDS` in that folder, with nothing of this checkout in sight."""
    outside = {
        name: value
        for name, value in os.environ.items()
        if not name.startswith(("PYTHON", "QUIESCE", "VIRTUAL_ENV"))
    }
    return subprocess.run(
        [str(command), *shlex.split(words)],
        cwd=folder,
        env=outside | {"XDG_CACHE_HOME": str(folder / "cache"), "COLUMNS": "100"},
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        timeout=TIMEOUT_s,
    )


def _refusal(ended: subprocess.CompletedProcess[str], wanted: str) -> str:
    lines = ended.stderr.splitlines()
    if ended.returncode == EXIT_BAD_INPUT and len(lines) == 1 and wanted in lines[0]:
        return "ok"
    return f"exit code {ended.returncode}: {' / '.join(lines[-3:])}"


def verdicts(command: Path, folder: Path) -> dict[str, str]:
    """Of every example, "ok" or what was wrong; by command, of several the first that is wrong."""
    write_files(folder)
    found: dict[str, str] = {}

    def note(name: str, verdict: str) -> None:
        if found.get(name, "ok") == "ok":
            found[name] = verdict

    for name, words in EXAMPLES:
        ended = typed(command, f"{name} {words}", folder)
        said = ended.stderr.splitlines()[-1:]
        note(name, "ok" if ended.returncode == 0 else f"exit code {ended.returncode}: {said}")
    for name, words in NEED_A_BUS:
        help_ends = typed(command, f"{name} --help", folder).returncode
        note(name, "ok" if help_ends == 0 else f"--help: exit code {help_ends}")
        note(name, _refusal(typed(command, f"{name} {words} {NO_BUS}", folder), "none0"))
    for extra, words in EXTRAS:
        note(f"extra {extra}", _refusal(typed(command, words, folder), f"quiesce[{extra}]"))
    return found


def bad_inputs(command: Path, folder: Path) -> dict[str, str]:
    """By what was typed "ok" or what was wrong, in a folder where the examples have run."""
    ended = subprocess.run(
        [str(command.parent / "python"), "-I", str(BAD_INPUTS), str(folder)],
        input=json.dumps(EXAMPLES),
        stdout=subprocess.PIPE,
        text=True,
        timeout=4 * TIMEOUT_s,
    )
    if ended.returncode != 0:
        raise BenchFailure(f"{BAD_INPUTS.name} ended with {ended.returncode}")
    return dict(json.loads(ended.stdout))
