"""What can go wrong, as the user sees it: one line and an exit code, never a traceback."""

from collections.abc import Iterator
from contextlib import contextmanager
from os.path import commonprefix

EXIT_FAILED = 1
EXIT_BAD_INPUT = 2
EXIT_INTERRUPTED = 130


class UsageError(Exception):
    """Bad input or a missing tool. The message says what is wrong and what to do."""


class BenchFailure(Exception):
    """The bench ended without an answer although its input was accepted."""


def one_line(text: object) -> str:
    """Any message on a single line."""
    return " ".join(str(text).split())


class Problems:
    """Gathers what is wrong with one file or one command, to be told in one message."""

    def __init__(self) -> None:
        self._found: list[str] = []

    @contextmanager
    def told(self) -> Iterator[None]:
        """A UsageError in here is kept, and what comes after it goes on."""
        try:
            yield
        except UsageError as error:
            if str(error) not in self._found:
                self._found.append(str(error))

    def refuse(self) -> None:
        """UsageError where something was wrong; the place that all begin with, 'FILE:LINE: ', is
        said once."""
        if not self._found:
            return
        start = commonprefix(self._found) if len(self._found) > 1 else ""
        place = start[: start.rfind(": ") + 2] if ": " in start else ""
        raise UsageError(place + " | ".join(text.removeprefix(place) for text in self._found))
