"""Runs cases in this process: the bench beside it, and the cases' own files in its memory."""

import os
import threading
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import tomli_w

from quiesce.base.errors import BenchFailure, UsageError
from quiesce.campaign.design import Case
from quiesce.campaign.documents import Sheet
from quiesce.campaign.recipe import SCENARIO, Parts, Recipe
from quiesce.engine.server import BenchServer

# A bench that is killed from outside is none that the case kills: it does so as often.
TRIES = 3
Write = Callable[[dict[str, Any], str], str]
_own = threading.local()


@dataclass(frozen=True)
class Row:
    """reason: why there are no figures; "": there are. crc32: of all telemetry of the run."""

    number: int
    seed: int
    labels: tuple[Any, ...]
    reason: str
    crc32: int | None
    figures: tuple[float | None, ...]


def written(value: Any, name: str, write: Write) -> Any:
    """The value with a path from `write(content, name)` in place of each content of a file. An
    array without elements goes: files say that there is none of a table by having none."""
    if isinstance(value, list):
        return [written(item, name, write) for item in value]
    if not isinstance(value, dict):
        return value
    inner = {
        key: written(item, f"{name}.{key}", write) for key, item in value.items() if item != []
    }
    return write(inner, name) if isinstance(value, Sheet) else inner


class Sheets:
    """Files in memory, which leave nothing behind when this process is killed."""

    def __init__(self) -> None:
        self._files: list[int] = []
        self._names: dict[str, str] = {}  # by path, as messages are to call them

    def scenario(self, parts: Parts) -> str:
        """Its path; it holds, and so do those of all that it names, until the next call."""
        self._names.clear()
        return str(written(parts.scenario, SCENARIO, self._write))

    def told(self, message: str) -> str:
        """The same on every machine, in every process."""
        for path, name in self._names.items():
            message = message.replace(path + ":", name + ":")
        return message

    def _write(self, content: dict[str, Any], name: str) -> str:
        if len(self._names) == len(self._files):
            self._files.append(os.memfd_create("quiesce"))
        file = self._files[len(self._names)]
        path = f"/proc/{os.getpid()}/fd/{file}"
        self._names[path] = name.removeprefix(f"{SCENARIO}.")
        os.ftruncate(file, 0)
        os.pwrite(file, tomli_w.dumps(content).encode(), 0)
        return path


class Worker:
    """One case after another."""

    def __init__(self) -> None:
        self._sheets = Sheets()
        self._server: BenchServer | None = None

    def row(self, recipe: Recipe, case: Case) -> Row:
        try:
            found = self._run(recipe.parts(case))
        except (UsageError, BenchFailure) as error:
            return Row(case.number, case.seed, tuple(case.labels), str(error), None, ())
        figures = tuple(figure_at(found, path) for path in recipe.figures)
        crc32 = found["telemetry_crc32"]
        return Row(case.number, case.seed, tuple(case.labels), "", crc32, figures)

    def close(self) -> None:
        if self._server is not None:
            self._server.close()
            self._server = None

    def _run(self, parts: Parts) -> dict[str, Any]:
        scenario = self._sheets.scenario(parts)
        try:
            return self._answer(options_of(parts, scenario))
        except UsageError as error:
            raise UsageError(self._sheets.told(str(error))) from None

    def _answer(self, words: list[str]) -> dict[str, Any]:
        for left in reversed(range(TRIES)):
            self._server = self._server or BenchServer()
            try:
                return self._server.run(words)
            except BenchFailure:
                self.close()
                if not left:
                    raise
        raise AssertionError("no try")


def options_of(parts: Parts, scenario: str) -> list[str]:
    """Of the bench's command run."""
    words = ["--scenario", scenario]
    for name, value in parts.options.items():
        words += [f"--{name}", value]
    for name, value in parts.settings.items():
        words += ["--set", f"{name}={value}"]
    return words


def write_files(parts: Parts, folder: Path, place: Path) -> list[str]:
    """The case's own files, for people, and the bench's options with them. place: where those of
    the folder come to be."""

    def write(content: dict[str, Any], name: str) -> str:
        file = f"{name.removeprefix(f'{SCENARIO}.')}.toml"
        (folder / file).write_text(tomli_w.dumps(content), encoding="utf-8")
        return str((place / file).resolve())

    return options_of(parts, str(written(parts.scenario, SCENARIO, write)))


def figure_at(answer: Any, path: str) -> float | None:
    """A number of the bench's answer, by keys and numbers of elements with dots between; None where
    it has none there."""
    for key in path.split("."):
        if isinstance(answer, list) and key.isdigit() and int(key) < len(answer):
            answer = answer[int(key)]
        elif isinstance(answer, dict):
            answer = answer.get(key)
        else:
            return None
    return float(answer) if isinstance(answer, int | float) else None


def run_chunk(recipe: Recipe, cases: Sequence[Case]) -> tuple[list[Row], float]:
    """Rows of these cases, and the seconds that it took. For a thread of any process."""
    start_s = time.monotonic()
    worker = _worker()
    return [worker.row(recipe, case) for case in cases], time.monotonic() - start_s


def _worker() -> Worker:
    if not hasattr(_own, "worker"):
        _own.worker = Worker()
    found: Worker = _own.worker
    return found
