"""Finished pieces of `quiesce tune`, in one JSON file, so that an interrupted run goes on."""

import fcntl
import hashlib
import json
import os
from functools import cache
from pathlib import Path
from typing import Any

from quiesce.base.errors import UsageError
from quiesce.base.paths import shown

SCHEMA = "quiesce-tune"
VERSION = 1
FILE_NAME = "work.json"
PACKAGE = Path(__file__).resolve().parents[1]


def bound_method() -> str:
    """Changes where the code does that finds bounds: results of two are not mixed."""
    return _code("optimum.bound", "optimum.descent", "optimum.goal", "tune.work")


@cache
def pulse_method() -> str:
    """The same for pulses."""
    return _code("tune.pulse", "tune.setting", "tune.tables")


def _code(*names: str) -> str:
    digest = hashlib.sha256()
    for name in names:
        digest.update((PACKAGE / f"{name.replace('.', '/')}.py").read_bytes())
    return digest.hexdigest()[:16]


class TuneStore:
    """Each piece is stored as it arrives. A damaged file, or one of other inputs, is refused."""

    def __init__(self, folder: Path, inputs: dict[str, Any], is_fresh: bool) -> None:
        """inputs: what the pieces depend on. is_fresh: whatever is there is given up.

        The folder is this store's alone as long as it is open. UsageError where it is another's.
        """
        self.file = folder / FILE_NAME
        self._folder = locked(folder)
        inputs = {**inputs, "method": bound_method()}
        head = {"schema": SCHEMA, "version": VERSION, "inputs": inputs}
        # As JSON tells it: infinities and tuples read back as they were written.
        self._head = json.loads(json.dumps(head))
        self._pieces: dict[str, Any] = {}
        try:
            if self.file.exists() and not is_fresh:
                self._pieces = self._read()
        except UsageError:
            self.close()
            raise

    def _read(self) -> dict[str, Any]:
        try:
            data = json.loads(self.file.read_text(encoding="utf-8"))
        except (OSError, ValueError) as error:
            raise self._damaged(str(error))
        if not isinstance(data, dict) or data.get("schema") != SCHEMA:
            raise self._damaged(f"schema is not {SCHEMA!r}")
        inputs, pieces = data.get("inputs"), data.get("pieces")
        if not isinstance(inputs, dict) or not isinstance(pieces, dict):
            raise self._damaged("no inputs or pieces")
        if data.get("check") != _check(pieces):
            raise self._damaged("its pieces do not match their checksum")
        wanted = self._head["inputs"]
        differing = [key for key in wanted if inputs.get(key) != wanted[key]]
        if differing or data.get("version") != VERSION:
            raise UsageError(
                f"{shown(self.file)} holds results of another {', '.join(differing) or 'version'}; "
                "name another --out, or start anew with --fresh"
            )
        return pieces

    def _damaged(self, why: str) -> UsageError:
        return UsageError(
            f"{shown(self.file)} is damaged ({why}); name another --out, or start anew with --fresh"
        )

    def close(self) -> None:
        """Another run may have the folder now."""
        os.close(self._folder)

    def __len__(self) -> int:
        return len(self._pieces)

    def __contains__(self, key: str) -> bool:
        return key in self._pieces

    def __getitem__(self, key: str) -> Any:
        return self._pieces[key]

    def put(self, key: str, value: Any) -> None:
        """Appears in the file whole or not at all."""
        self._pieces[key] = json.loads(json.dumps(value))
        data = {**self._head, "check": _check(self._pieces), "pieces": self._pieces}
        staging = self.file.with_suffix(".part")
        staging.write_text(json.dumps(data, indent=1) + "\n", encoding="utf-8")
        staging.replace(self.file)


def locked(folder: Path) -> int:
    """The folder, made where there is none, as a file descriptor that holds its lock."""
    folder.mkdir(parents=True, exist_ok=True)
    descriptor = os.open(folder, os.O_RDONLY)
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        os.close(descriptor)
        raise UsageError(f"{shown(folder)}: another run works there; wait, or name another --out")
    return descriptor


def _check(pieces: dict[str, Any]) -> str:
    return hashlib.sha256(json.dumps(pieces, sort_keys=True).encode()).hexdigest()[:16]
