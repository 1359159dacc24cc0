"""Columns of numbers under names, whatever file they are from.

Errors name the file and its line or row (1-based), say what is there and what to do.
"""

from abc import ABC, abstractmethod
from pathlib import Path

import numpy as np

from quiesce.base.errors import UsageError, one_line
from quiesce.base.paths import shown

# Beyond any measured value, in any unit.
MAX_VALUE = 1e18
NO_LINE = 0


def at(file: Path, line: int, text: str) -> UsageError:
    """'FILE:LINE: text' on one line; 'FILE: text' where nothing has a line (NO_LINE)."""
    place = f"{shown(file)}:{line}" if line != NO_LINE else shown(file)
    return UsageError(f"{place}: {one_line(text)}")


def clipped(text: str, most: int = 40) -> str:
    """A cell as it can be shown: printable, not long."""
    text = "".join(c if c.isprintable() else "?" for c in text.strip())
    return text if len(text) <= most else text[: most - 3] + "..."


class Table(ABC):
    """head: names of the columns, units in them where they have some; head_line: of the header in
    the file, NO_LINE where it has no lines."""

    file: Path
    head: list[str]
    head_line: int

    @property
    def headers(self) -> str:
        return ", ".join(clipped(name) for name in self.head if name)

    @property
    def note(self) -> str:
        """What a user may want to know of how it was read; mostly nothing."""
        return ""

    def index(self, name: str) -> int:
        """UsageError where no or more than one column has this name."""
        if self.head.count(name) == 1:
            return self.head.index(name)
        problem = "more than one column is" if name in self.head else "no column is"
        raise at(
            self.file, self.head_line,
            f"{problem} named '{clipped(name)}'; there are: {self.headers}",
        )  # fmt: skip

    @abstractmethod
    def texts(self, names: list[str]) -> list[tuple[str, ...]]:
        """Cells of the named columns, row by row."""

    @abstractmethod
    def numbers(self, names: list[str]) -> tuple[np.ndarray, np.ndarray]:
        """Lines or rows [n] in the file and values [n, columns] of the named columns; UsageError
        where one is no finite number."""
