"""The state file of a search: written whole after every generation, read again by --resume.

It holds what determines the search (its settings), every rule base that was evaluated with its
figures, and a digest of each generation. Resuming runs the search again from its seed; what was
evaluated is looked up, so this costs next to nothing, and from there on the search goes on as it
would have. The digests prove that it was the same search.
"""

import hashlib
import json
import os
from collections.abc import Sequence
from dataclasses import astuple, dataclass, field
from pathlib import Path
from typing import Any

from quiesce.base.errors import UsageError, one_line
from quiesce.base.paths import shown
from quiesce.rules.optimize.genes import Genome
from quiesce.rules.optimize.objective import Outcome, Steady

SCHEMA = "quiesce-rules-optimize"
VERSION = 2  # raised where a method's populations are no longer what they were
FILE_NAME = "state.json"
ANEW = "leave out --resume and give --anew to start again"


@dataclass
class State:
    settings: dict[str, Any]  # values of JSON
    evaluated: dict[Genome, Outcome] = field(default_factory=dict)
    digests: list[str] = field(default_factory=list)  # of each finished generation
    is_finished: bool = False

    def text(self) -> str:
        evaluated = [
            [genome, [astuple(steady) for steady in outcome]]
            for genome, outcome in self.evaluated.items()
        ]
        return json.dumps(
            {
                "schema": SCHEMA, "version": VERSION, "settings": self.settings,
                "is_finished": self.is_finished, "digests": self.digests, "evaluated": evaluated,
            }
        )  # fmt: skip

    def save(self, file: Path) -> None:
        """All of it or nothing."""
        staged = file.with_suffix(f".{os.getpid()}.new")
        try:
            staged.write_text(self.text(), encoding="utf-8")
            staged.replace(file)
        finally:
            staged.unlink(missing_ok=True)


def digest(genomes: Sequence[Genome]) -> str:
    return hashlib.sha256(repr(list(genomes)).encode()).hexdigest()[:16]


def is_genome(value: Any, levels: Sequence[int]) -> bool:
    return (
        isinstance(value, list)
        and len(value) == len(levels)
        and all(type(g) is int and 0 <= g < n for g, n in zip(value, levels, strict=True))
    )


def parse_outcome(rows: Any, count: int) -> Outcome:
    outcome = tuple(Steady(*map(float, row)) for row in rows)
    if len(outcome) != count:
        raise ValueError(f"{len(outcome)} figures where there are {count} steady states")
    return outcome


def parse(text: str, levels: Sequence[int], places: int) -> State:
    """ValueError, TypeError or KeyError where it is no state of a search over such genomes."""
    data = json.loads(text)
    if not isinstance(data, dict) or (data["schema"], data["version"]) != (SCHEMA, VERSION):
        raise ValueError(f"not {SCHEMA} version {VERSION}")
    settings, digests = data["settings"], data["digests"]
    if not isinstance(settings, dict) or not isinstance(digests, list):
        raise TypeError("settings or digests are missing")
    evaluated = {}
    for genome, rows in data["evaluated"]:
        if not is_genome(genome, levels):
            raise ValueError(f"{genome} is no genome of this search")
        evaluated[tuple(genome)] = parse_outcome(rows, places)
    return State(settings, evaluated, [str(d) for d in digests], data["is_finished"] is True)


def difference(old: dict[str, Any], new: dict[str, Any]) -> str | None:
    """The first setting that differs, in words."""
    for key in dict.fromkeys([*new, *old]):
        if old.get(key) != new.get(key):
            return f"{key}: {json.dumps(old.get(key))}, not {json.dumps(new.get(key))}"
    return None


def load(file: Path, settings: dict[str, Any], levels: Sequence[int], places: int) -> State:
    """UsageError where the file is not a state, or is one of a search with other settings."""
    text = read(file)
    try:
        data = json.loads(text)
        if data["schema"] == SCHEMA and data["version"] != VERSION:
            raise UsageError(
                f"{shown(file)} is of another version of this command ({data['version']}, not "
                f"{VERSION}), whose searches went another way; {ANEW}"
            )
        found = difference(data["settings"], settings)
        state = None if found else parse(text, levels, places)
    except (ValueError, TypeError, KeyError, AttributeError) as error:
        raise UsageError(f"{shown(file)} is damaged ({one_line(error)}); {ANEW}")
    if state is None:
        raise UsageError(
            f"{shown(file)} is of another search ({found}); give its options again, or {ANEW}"
        )
    return state


def read(file: Path) -> str:
    try:
        return file.read_text(encoding="utf-8")
    except FileNotFoundError:
        raise UsageError(f"{shown(file)} does not exist; there is nothing to resume")
    except UnicodeDecodeError:
        raise UsageError(f"{shown(file)} is damaged (not a text file); {ANEW}")


def unfinished(file: Path) -> int | None:
    """Finished generations of an unfinished search in a file; None where there is none."""
    try:
        data = json.loads(file.read_text(encoding="utf-8"))
        return None if data["is_finished"] else len(data["digests"])
    except (OSError, ValueError, TypeError, KeyError):
        return None
