"""Where rows are kept: one SQLite file, a row a case, and what it was that made them.

SQLite rather than parts in Parquet: a chunk of rows is there whole or not at all wherever a process
is killed, the case's number is the key and no row comes twice, there are no thousands of small
files to be merged, and Python has it.
"""

import fcntl
import hashlib
import json
import os
import sqlite3
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from quiesce.base.errors import UsageError
from quiesce.base.paths import shown
from quiesce.campaign.worker import Row

NAME = "campaign.sqlite"
OWN = ("number", "seed", "reason", "telemetry_crc32")


def quoted(name: str) -> str:
    return '"' + name.replace('"', '""') + '"'


class Store:
    """factors, figures: names of columns. UsageError where the file is not such a store."""

    def __init__(
        self, file: Path, factors: Sequence[str], figures: Sequence[str], facts: Mapping[str, str]
    ) -> None:
        self.file = file
        self.factors, self.figures = tuple(factors), tuple(figures)
        self._base = sqlite3.connect(file)
        columns = ["number INTEGER PRIMARY KEY", "seed INTEGER NOT NULL"]
        columns += [quoted(name) for name in factors]
        columns += ["reason TEXT NOT NULL", "telemetry_crc32 INTEGER"]
        columns += [f"{quoted(name)} REAL" for name in figures]
        try:
            with self._base:
                self._base.execute(
                    "CREATE TABLE IF NOT EXISTS facts (name TEXT PRIMARY KEY, value)"
                )
                self._base.execute(f"CREATE TABLE IF NOT EXISTS cases ({', '.join(columns)})")
                self._agree(facts)
        except sqlite3.Error as error:
            self._base.close()
            raise UsageError(f"{shown(file)}: {error}; name another --out") from None
        except UsageError:
            self._base.close()
            raise

    def _agree(self, facts: Mapping[str, str]) -> None:
        """Facts are written once; a store of other ones is refused."""
        known = dict(self._base.execute("SELECT name, value FROM facts"))
        if not known:
            self._base.executemany("INSERT INTO facts VALUES (?, ?)", facts.items())
            return
        other = [name for name in {**known, **facts} if known.get(name) != facts.get(name)]
        if other:
            raise UsageError(
                f"{shown(self.file)} has {self.count()} rows that were made otherwise "
                f"({', '.join(sorted(other))}); name another --out, or remove it"
            )

    def close(self) -> None:
        self._base.close()

    def facts(self) -> dict[str, str]:
        return dict(self._base.execute("SELECT name, value FROM facts ORDER BY name"))

    def put(self, rows: Iterable[Row]) -> None:
        """All of them or none. A case that is there already is a mistake of the caller's."""
        blank = (None,) * len(self.figures)
        values = [
            (r.number, r.seed, *r.labels, r.reason, r.crc32, *(r.figures or blank)) for r in rows
        ]
        marks = ", ".join("?" * (len(OWN) + len(self.factors) + len(self.figures)))
        with self._base:
            self._base.executemany(f"INSERT INTO cases VALUES ({marks})", values)

    def count(self) -> int:
        return int(self._base.execute("SELECT count(*) FROM cases").fetchone()[0])

    def failed(self) -> int:
        query = "SELECT count(*) FROM cases WHERE reason <> ''"
        return int(self._base.execute(query).fetchone()[0])

    def missing(self, total: int) -> list[int]:
        """Numbers of cases without a row."""
        known = np.zeros(total, dtype=bool)
        numbers = [number for (number,) in self._base.execute("SELECT number FROM cases")]
        known[numbers] = True
        return np.flatnonzero(~known).tolist()

    def row(self, number: int) -> tuple[Any, ...] | None:
        found: tuple[Any, ...] | None = self._base.execute(
            "SELECT * FROM cases WHERE number = ?", (number,)
        ).fetchone()
        return found

    def reasons(self) -> list[tuple[str, int, int]]:
        """Why cases failed: the reason, how many, the first one; most frequent first."""
        query = (
            "SELECT reason, count(*), min(number) FROM cases WHERE reason <> '' "
            "GROUP BY reason ORDER BY 2 DESC, 3"
        )
        return list(self._base.execute(query))

    def column(self, name: str) -> np.ndarray:
        """Of all cases in order; of a figure as floats, NaN where there is none."""
        query = f"SELECT {quoted(name)} FROM cases ORDER BY number"
        values = [value for (value,) in self._base.execute(query)]
        return np.array(values, dtype=float if name in self.figures else None)

    def digest(self) -> str:
        """SHA-256 of all rows in the order of their numbers."""
        digest = hashlib.sha256()
        for row in self._base.execute("SELECT * FROM cases ORDER BY number"):
            digest.update(json.dumps(row).encode())
        return digest.hexdigest()


@contextmanager
def claimed(folder: Path) -> Iterator[None]:
    """UsageError where another campaign is at work in this folder, or it cannot be written."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        file = os.open(folder, os.O_RDONLY)
    except OSError as error:
        raise UsageError(f"cannot write to {shown(folder)}: {error.strerror}; name another --out")
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        os.close(file)
        raise UsageError(f"{shown(folder)}: another campaign is at work there") from None
    try:
        yield
    finally:
        os.close(file)
