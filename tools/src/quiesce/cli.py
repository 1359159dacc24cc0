"""The command line `quiesce`: one module a command, and the one place where errors end."""

import argparse
import os
import sys
from typing import NoReturn

from quiesce import (
    __version__,
    cmd_bench,
    cmd_can,
    cmd_chain,
    cmd_hil,
    cmd_identify,
    cmd_params,
    cmd_plant,
    cmd_record,
    cmd_replay,
    cmd_rules,
    cmd_sweep,
    cmd_tune,
)
from quiesce.errors import (
    EXIT_BAD_INPUT,
    EXIT_FAILED,
    EXIT_INTERRUPTED,
    BenchFailure,
    UsageError,
    one_line,
)

COMMANDS = (
    cmd_hil,
    cmd_replay,
    cmd_record,
    cmd_plant,
    cmd_params,
    cmd_chain,
    cmd_rules,
    cmd_sweep,
    cmd_identify,
    cmd_tune,
    cmd_can,
    cmd_bench,
)

EPILOG = """examples:
  quiesce hil                                   the published scenarios, table and report
  quiesce replay FILE.csv --column acc --unit g a recorded acceleration through the firmware
  quiesce plant check my_plant.toml             is my own plant file right?
  quiesce params                                every parameter of the controller
  quiesce rules convert FILE.fis --to fcl       a fuzzy rule file in another format
  quiesce sweep --identify FILE.csv             a plant file from a recorded sweep
  quiesce identify FILE.csv --model all         damper models from a test rig's recording
  quiesce tune my_plant.toml                    pulses of current for my own plant
  quiesce can monitor --bus socketcan:can0      state, fault and currents, live
  quiesce bench signal --check                  the sensing chain's figures and goals

Progress and errors go to stderr, results to stdout. Exit codes: 0 ok, 1 a check failed,
2 bad input or a missing tool (one line says which and what to do), 130 interrupted.
'quiesce COMMAND --help' has the options of one command.
"""


class Parser(argparse.ArgumentParser):
    """Refuses bad arguments in one line."""

    def error(self, message: str) -> NoReturn:
        raise UsageError(f"{one_line(message)}; see '{self.prog} --help'")


def make_parser() -> argparse.ArgumentParser:
    parser = Parser(
        prog="quiesce",
        description="Vibration control with magnetorheological dampers: run the controller\n"
        "against a simulated structure, on this machine and as a Cortex-M image, or over a\n"
        "recording.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    parser.add_argument("--version", action="version", version=f"quiesce {__version__}")
    commands = parser.add_subparsers(metavar="COMMAND", required=True)
    for command in COMMANDS:
        command.add_parser(commands)
    return parser


def say(message: object) -> None:
    print(f"quiesce: {one_line(message)}", file=sys.stderr)


def run(arguments: list[str]) -> int:
    args = make_parser().parse_args(cmd_identify.with_action(arguments))
    status = args.run(args)
    sys.stdout.flush()
    return status


def main(arguments: list[str] | None = None) -> int:
    """Runs one command and returns its exit code; every failure is one line on stderr."""
    try:
        return run(sys.argv[1:] if arguments is None else arguments)
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
