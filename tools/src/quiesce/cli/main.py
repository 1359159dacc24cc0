"""The command line `quiesce`: one module a command, imported only when it is the one to run."""

import argparse
import sys
from collections.abc import Mapping
from importlib import import_module
from pathlib import Path
from types import ModuleType

from quiesce import __version__
from quiesce.base.command import Parser, exit_code_of
from quiesce.base.errors import UsageError
from quiesce.base.paths import root

# Name, module, what the list says, by what somebody is at. A module has add_parser(subparsers),
# which sets `run`, and may have words_of(arguments): what the parser gets in their place.
GROUPS = {
    "try": (
        ("hil", "hil", "the published scenarios in closed loop; table and report"),
        ("replay", "replay", "recorded motion through the firmware"),
        ("record", "record", "the simulated accelerometer's signal as a CSV file"),
        ("compare", "compare", "control laws side by side on recorded ground motions"),
        ("campaign", "campaign", "thousands of cases: grids, samples, sensitivities; resumable"),
    ),
    "identify": (
        (
            "identify",
            "identify.command",
            "damper models from a test rig's recordings; plan, compare, inverse, export",
        ),
        ("sweep", "sweep", "excitation and current steps to record, and the plant from that"),
        ("new", "new.command", "plant, board and scenario files of your own structure"),
    ),
    "design": (
        ("rules", "rules.command", "fuzzy rule files"),
        ("law", "law.command", "published control laws as tables: list, make"),
        (
            "tune",
            "tune.command",
            "the phase law's pulses for a plant, by optimal control; gains of laws",
        ),
    ),
    "deploy": (
        ("board", "board.command", "board files: sensors, dampers, their places and limits"),
        ("params", "params", "parameters of the controller: unit, range, default"),
        ("table", "table.command", "table files: show, check, diff, stamp"),
        ("can", "can.command", "CAN bus: monitor, record, decode, parameters, emergency stop"),
        ("fmu", "fmu.command", "plant, damper and controller for co-simulation (FMI 2 and 3)"),
        ("firmware", "firmware.command", "images of boards: build, info, verify, flash"),
        ("commission", "commission", "from an unknown structure to a verified controller, guided"),
        ("live", "live", "a page on which a controller is seen, stopped and commanded"),
    ),
    "verify": (
        ("plant", "plant", "is a plant file right?"),
        ("chain", "chain", "magnitude and phase of the conditioning"),
        ("report", "report", "two recordings, before and after: figures, limits, a page"),
    ),
    "shell": (
        ("completion", "completion", "commands, options and files by TAB, in bash, zsh and tcsh"),
    ),
}
COMMANDS = tuple(command for group in GROUPS.values() for command in group)

EPILOG = """examples:
  quiesce hil                                   the published scenarios, table and report
  quiesce replay FILE.csv --column acc --unit g a recorded acceleration through the firmware
  quiesce new plant press --mass 120 --freq 2.9 ..   files of my own structure
  quiesce plant check my_plant.toml             is my own plant file right?
  quiesce board check my_board.toml             and my board of sensors and dampers?
  quiesce params                                every parameter of the controller
  quiesce rules convert FILE.fis --to fcl       a fuzzy rule file in another format
  quiesce law make skyhook --board my_board.toml -o sky.table   a published law for my board
  quiesce sweep --identify FILE.csv             a plant file from a recorded sweep
  quiesce identify FILE.csv --model all         damper models from a test rig's recording
  quiesce tune my_plant.toml                    pulses of current for my own plant
  quiesce report before.mf4 after.mf4           what changed, as a page to hand over
  quiesce fmu controller --law phase -o controller.fmu   the firmware in somebody else's model
  quiesce commission rig --sim PLANT.toml       from an unknown structure to a verified controller
  quiesce can monitor --bus socketcan:can0      state, fault and currents, live

Progress and errors go to stderr, results to stdout. Exit codes: 0 ok, 1 a check failed,
2 bad input or a missing tool (one line says which and what to do), 130 interrupted.
'quiesce help COMMAND' has the options of one command. Benchmarks: ./tools/benchmark --help.
"""


SHIPPED = ("sim_hil/data/", "firmware/plants/")


def module_of(name: str) -> ModuleType | None:
    return next((import_module(f"quiesce.cli.{m}") for one, m, _ in COMMANDS if one == name), None)


class Overview(Parser):
    """The parser of all commands, whose help has them by group."""

    def format_help(self) -> str:
        listed = "\n\n".join(
            f"{title}\n" + "\n".join(f"  {name:10s} {text}" for name, _, text in group)
            for title, group in GROUPS.items()
        )
        return f"usage: quiesce COMMAND ...\n\n{self.description}\n\n{listed}\n\n{EPILOG}"


def make_parser(modules: Mapping[str, ModuleType | None]) -> argparse.ArgumentParser:
    """With all options of the commands in `modules`, and the others' names."""
    parser = Overview(
        prog="quiesce",
        description="Vibration control with magnetorheological dampers: the controller against a\n"
        "simulated structure, as a Cortex-M image, over a recording, and on a bus.",
        allow_abbrev=False,
    )
    parser.add_argument("-v", "--version", action="version", version=f"quiesce {__version__}")
    commands = parser.add_subparsers(metavar="COMMAND", required=True, parser_class=Parser)
    for name, _, text in COMMANDS:
        if (module := modules.get(name)) is not None:
            module.add_parser(commands)
        else:
            commands.add_parser(name, help=text)
    return parser


def whole_parser() -> argparse.ArgumentParser:
    """With all options of all commands."""
    return make_parser({name: module_of(name) for name, _, _ in COMMANDS})


def with_shipped(word: str) -> str:
    """A file that ships, by the name that help and pages give it, from any folder."""
    if not word.startswith(SHIPPED) or Path(word).exists():
        return word
    file = root() / word
    return str(file) if file.exists() else word


def run(arguments: list[str]) -> int:
    arguments = [with_shipped(word) for word in arguments]
    if arguments[:1] == ["help"]:
        arguments = [*arguments[1:], "--help"]
    wanted = arguments[0] if arguments else ""
    if wanted.startswith("-") and wanted not in ("-h", "--help", "-v", "--version"):
        raise UsageError(f"unknown option '{wanted}'; see 'quiesce --help'")
    module = module_of(wanted)
    words_of = getattr(module, "words_of", list)
    args = make_parser({wanted: module}).parse_args(words_of(arguments))
    return args.run(args)


def main(arguments: list[str] | None = None) -> int:
    """Runs one command and returns its exit code; every failure is one line on stderr."""
    words = sys.argv[1:] if arguments is None else arguments
    return exit_code_of("quiesce", lambda: run(words))
