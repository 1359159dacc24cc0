"""What can go wrong, as the user sees it: one line and an exit code, never a traceback."""

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
