"""How a command line ends: the parser that refuses in one line, and exit codes for failures."""

import argparse
import os
import sys
from collections.abc import Callable
from typing import NoReturn

from quiesce.base.errors import (
    EXIT_BAD_INPUT,
    EXIT_FAILED,
    EXIT_INTERRUPTED,
    BenchFailure,
    UsageError,
    one_line,
)


class Parser(argparse.ArgumentParser):
    """Refuses bad arguments in one line."""

    def error(self, message: str) -> NoReturn:
        raise UsageError(f"{one_line(message)}; see '{self.prog} --help'")


def exit_code_of(program: str, run: Callable[[], int]) -> int:
    """Runs a command and returns its exit code; every failure is one line on stderr."""

    def say(message: object) -> None:
        print(f"{program}: {one_line(message)}", file=sys.stderr)

    try:
        status = run()
        sys.stdout.flush()
        return status
    except UsageError as error:
        say(error)
        return EXIT_BAD_INPUT
    except BenchFailure as error:
        say(error)
        return EXIT_FAILED
    except KeyboardInterrupt:
        say("interrupted; nothing was written")
        return EXIT_INTERRUPTED
    except BrokenPipeError:
        # The reader of stdout has gone; leave nothing for the interpreter to flush into it.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return EXIT_FAILED
    except OSError as error:
        say(f"{error.filename or 'file'}: {error.strerror or error}")
        return EXIT_BAD_INPUT
    except Exception as error:
        if os.environ.get("QUIESCE_DEBUG"):
            raise
        say(f"internal error, {type(error).__name__}: {error} (QUIESCE_DEBUG=1 shows where)")
        return EXIT_FAILED
