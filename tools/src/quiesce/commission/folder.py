"""What a commissioning has come to: one file in its folder, whole or as it was before."""

import json
import os
from pathlib import Path
from typing import Any

from quiesce.base.errors import UsageError, one_line
from quiesce.base.paths import shown

STATE = "commission.json"
SCHEMA, VERSION = "quiesce-commission", 1
KEYS = {"schema": str, "version": int, "wants": dict, "settings": dict, "results": dict}


class Folder:
    """wants: what was asked for; settings: parameters that the controller has by now, NAME: value;
    results: of the steps that are done, by their names, in order."""

    def __init__(self, path: Path) -> None:
        """UsageError, in one line, where its file cannot be read or is none."""
        self.path = path
        self.wants: dict[str, Any] = {}
        self.settings: dict[str, int | str] = {}
        self.results: dict[str, dict[str, Any]] = {}
        if path.exists() and not path.is_dir():
            raise UsageError(f"{shown(path)} is a file; name a folder")
        if self.file.exists():
            said = read(self.file)
            self.wants, self.settings = said["wants"], said["settings"]
            self.results = said["results"]

    @property
    def file(self) -> Path:
        return self.path / STATE

    def done(self, step: str, result: dict[str, Any]) -> None:
        self.results[step] = result
        self.save()

    def forget(self, steps: list[str]) -> None:
        """Of these nothing is known any more; what the controller was given stays."""
        for step in steps:
            self.results.pop(step, None)
        self.save()

    def save(self) -> None:
        """UsageError where it cannot be written; the file is as it was before."""
        said = {
            "schema": SCHEMA,
            "version": VERSION,
            "wants": self.wants,
            "settings": self.settings,
            "results": self.results,
        }
        try:
            self.path.mkdir(parents=True, exist_ok=True)
            new = self.path / f".{STATE}-{os.getpid()}"
            with new.open("w", encoding="utf-8") as stream:
                stream.write(json.dumps(said, indent=1) + "\n")
                stream.flush()
                os.fsync(stream.fileno())
            os.replace(new, self.file)
        except OSError as error:
            raise UsageError(f"cannot write {shown(self.file)}: {error.strerror}")


def read(file: Path) -> dict[str, Any]:
    try:
        said = json.loads(file.read_text(encoding="utf-8"))
    except (OSError, ValueError, RecursionError) as error:
        raise UsageError(f"{shown(file)}: cannot be read: {one_line(error)}; --fresh begins anew")
    is_whole = isinstance(said, dict) and all(
        isinstance(said.get(key), kind) for key, kind in KEYS.items()
    )
    if not is_whole or said["schema"] != SCHEMA or said["version"] != VERSION:
        raise UsageError(
            f"{shown(file)}: no file of 'quiesce commission', version {VERSION}; --fresh begins "
            "anew"
        )
    if not all(isinstance(one, dict) for one in said["results"].values()):
        raise UsageError(f"{shown(file)}: a result is no object; --fresh begins anew")
    return said
