"""Trials of a tuning, one a line of a file that only grows, so that an interrupted one goes on."""

import json
import os
import threading
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from quiesce.base.errors import UsageError
from quiesce.base.paths import shown
from quiesce.compare.figures import Figures
from quiesce.tune.store import locked

SCHEMA = "quiesce-tune-law"
VERSION = 1
FILE_NAME = "trials.jsonl"


@dataclass(frozen=True)
class Trial:
    """runs: figures by record, means over seeds; none where the values were refused, and why."""

    values: dict[str, float]
    runs: dict[str, Figures]
    refused: str = ""


def key_of(values: Mapping[str, float]) -> str:
    return json.dumps(values, sort_keys=True)


class TrialStore:
    """What was tried, also in earlier runs with the same inputs.

    A line that was being written when a run ended is dropped; anything else that is not right is
    refused. The folder is this store's alone as long as it is open.
    """

    def __init__(self, folder: Path, inputs: Mapping[str, Any], is_fresh: bool) -> None:
        """inputs: what a trial's figures depend on, values of JSON. is_fresh: whatever is there is
        given up. UsageError where the file is damaged, of other inputs, or another run's."""
        self.file = folder / FILE_NAME
        self._folder = locked(folder)
        self._lock = threading.Lock()
        self._trials: dict[str, Trial] = {}
        head = json.loads(json.dumps({"schema": SCHEMA, "version": VERSION, **inputs}))
        try:
            if self.file.exists() and not is_fresh:
                self._read(head)
            else:
                self.file.write_text(json.dumps(head) + "\n", encoding="utf-8")
        except UsageError:
            self.close()
            raise

    def _read(self, wanted: dict[str, Any]) -> None:
        text = self.file.read_text(encoding="utf-8", errors="replace")
        whole, _, rest = text.rpartition("\n")
        lines = whole.split("\n")
        try:
            head, *rows = [json.loads(line) for line in lines]
            trials = [Trial(row["values"], row["runs"], row["refused"]) for row in rows]
            is_ours = head["schema"] == SCHEMA
        except (ValueError, KeyError, TypeError):
            is_ours = False
        if not is_ours:
            raise UsageError(
                f"{shown(self.file)} is damaged; name another --out, or start anew with --fresh"
            )
        differing = [name for name in wanted if head.get(name) != wanted[name]]
        if differing:
            raise UsageError(
                f"{shown(self.file)} holds trials of another {', '.join(differing)}; name another "
                "--out, or start anew with --fresh"
            )
        if rest:
            self.file.write_text(whole + "\n", encoding="utf-8")
        self._trials = {key_of(one.values): one for one in trials}

    def find(self, values: Mapping[str, float]) -> Trial | None:
        with self._lock:
            return self._trials.get(key_of(values))

    def add(self, trial: Trial) -> None:
        """From several threads."""
        with self._lock:
            self._trials[key_of(trial.values)] = trial
            with self.file.open("a", encoding="utf-8") as out:
                out.write(json.dumps(asdict(trial)) + "\n")

    def close(self) -> None:
        """Another run may have the folder now."""
        os.close(self._folder)
