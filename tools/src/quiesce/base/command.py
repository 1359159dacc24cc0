"""How a command line ends: the parser that refuses in one line, and exit codes for failures."""

import argparse
import math
import os
import signal
import sys
import threading
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from typing import Any, NoReturn

from quiesce.base.errors import (
    EXIT_BAD_INPUT,
    EXIT_FAILED,
    EXIT_INTERRUPTED,
    BenchFailure,
    UsageError,
    one_line,
)
from quiesce.base.nearest import meant


class Parser(argparse.ArgumentParser):
    """Refuses bad arguments in one line."""

    def error(self, message: str) -> NoReturn:
        raise UsageError(f"{one_line(message)}; see '{self.prog} --help'")

    def parse_known_args(  # type: ignore[override]
        self, args: Sequence[str] | None = None, namespace: Any = None
    ) -> tuple[argparse.Namespace, list[str]]:
        """What is left over is told by the parser of the command that it was said to. An empty word
        is a variable of a script that was not set, and no folder."""
        words = sys.argv[1:] if args is None else list(args)
        for option, word in zip(["", *words], words, strict=False):
            if not word or (word.startswith("--") and word.endswith("=")):
                self.error("an argument is empty: " + (word or f"{option} ''"))
        found, rest = super().parse_known_args(args, namespace)
        if rest:
            near = meant(rest[0].partition("=")[0], self._option_string_actions)
            self.error(f"unrecognized arguments: {' '.join(rest)}{near}")
        return found, rest

    def _check_value(self, action: argparse.Action, value: Any) -> None:
        if action.choices is not None and value not in action.choices and isinstance(value, str):
            known = [str(one) for one in action.choices]
            near = meant(value, known)
            raise argparse.ArgumentError(
                action, f"invalid choice: '{value}' (choose from {', '.join(known)}){near}"
            )
        super()._check_value(action, value)


def whole_number(low: int, high: int) -> Callable[[str], int]:
    """A type for argparse: an integer in low .. high."""

    def read(text: str) -> int:
        try:
            value = int(text)
        except ValueError:
            value = low - 1
        if not low <= value <= high:
            raise argparse.ArgumentTypeError(
                f"expected an integer in {low} .. {high}, found '{text}'"
            )
        return value

    return read


def real_number(low: float, high: float, what: str = "") -> Callable[[str], float]:
    """A type for argparse: a finite number in low .. high, which may be infinite. what: its
    name."""

    def read(text: str) -> float:
        try:
            value = float(text)
        except ValueError:
            value = math.nan
        if not (low <= value <= high and math.isfinite(value)):
            name = f"{what}, a number" if what else "a number"
            span = f" in {low:g} .. {high:g}" if math.isfinite(low) or math.isfinite(high) else ""
            raise argparse.ArgumentTypeError(f"expected {name}{span}, found '{text}'")
        return value

    return read


# A type for argparse: any finite number.
finite_number = real_number(-math.inf, math.inf)


@contextmanager
def ended_alike() -> Iterator[None]:
    """Whoever ends it, Ctrl-C or SIGTERM: what is finished is kept, and no process stays behind."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    before = signal.signal(signal.SIGTERM, signal.default_int_handler)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, before)


def output_is_written() -> bool:
    """False where standard output takes no more, BrokenPipeError where its reader has gone; nothing
    is left in it that the interpreter would try again."""
    try:
        sys.stdout.flush()
    except OSError as error:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        if isinstance(error, BrokenPipeError):
            raise
        return False
    return True


def status_of(run: Callable[[], int]) -> int:
    """Also of a run that ends in its help text."""
    try:
        return run()
    except SystemExit as end:
        return int(end.code or 0)


def exit_code_of(program: str, run: Callable[[], int]) -> int:
    """Runs a command and returns its exit code; every failure is one line on stderr."""

    def say(message: object) -> None:
        print(f"{program}: {one_line(message)}", file=sys.stderr)

    try:
        with ended_alike():
            status = status_of(run)
        if not output_is_written():
            say("standard output: not all could be written; is its disk full?")
            return EXIT_BAD_INPUT
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
        with suppress(BrokenPipeError):
            output_is_written()
        return EXIT_FAILED
    except OSError as error:
        with suppress(BrokenPipeError):
            output_is_written()
        # A write does not say where to: files' own commands do.
        where = error.filename or "standard output, or a file"
        say(f"{where}: {error.strerror or error}")
        return EXIT_BAD_INPUT
    except Exception as error:
        if os.environ.get("QUIESCE_DEBUG"):
            raise
        say(f"internal error, {type(error).__name__}: {error} (QUIESCE_DEBUG=1 shows where)")
        return EXIT_FAILED
