"""Scenario files: found by name or path. The bench validates what is in them."""

import tomllib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from quiesce.base.errors import UsageError, one_line
from quiesce.base.nearest import listed
from quiesce.base.paths import scenario_folder, shown
from quiesce.engine.bench import Bench
from quiesce.engine.board import Board, load_board

SCHEMA = "quiesce-scenario"
TRACE_EQUALITY = "trace_equality"


@dataclass(frozen=True)
class Scenario:
    name: str
    file: Path
    plant_file: Path
    windows_s: tuple[tuple[float, float], ...]  # where the steady state is judged
    transient_s: float | None  # start of the step's transient
    board: Board | None = None

    @property
    def is_step(self) -> bool:
        return self.transient_s is not None


def read_toml(file: Path) -> dict[str, Any]:
    try:
        return tomllib.loads(file.read_text(encoding="utf-8"))
    except OSError as error:
        raise UsageError(f"{shown(file)}: {error.strerror}; name a scenario file")
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise UsageError(f"{shown(file)}: not a TOML file: {one_line(error)}")


def names() -> list[str]:
    """Scenarios that ship with the project."""
    files = sorted(scenario_folder().glob("*.toml"))
    return [f.stem for f in files if read_toml(f).get("schema") == SCHEMA]


def find_file(name: str) -> Path:
    """A path, or the name of a scenario that ships with the project."""
    if name.endswith(".toml") or "/" in name:
        return Path(name)
    file = scenario_folder() / f"{name}.toml"
    if name not in names():
        raise UsageError(f"no scenario '{name}', and no .toml file; {listed(name, names())}")
    return file


def load(bench: Bench, name: str) -> Scenario:
    """UsageError, in the bench's words, where the scenario, its plant or its board is not valid."""
    file = find_file(name)
    data = read_toml(file)
    bench.call("scenario-check", str(file))
    return Scenario(
        name=data["name"],
        file=file,
        plant_file=(file.parent / data["plant"]).resolve(),
        windows_s=tuple((w["start_s"], w["end_s"]) for w in data.get("window", [])),
        transient_s=data.get("transient", {}).get("start_s"),
        board=load_board(bench, file.parent / data["board"]) if "board" in data else None,
    )
