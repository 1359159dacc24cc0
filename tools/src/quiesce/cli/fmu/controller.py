"""`quiesce fmu controller`: the firmware as an FMU."""

import argparse
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

from quiesce.cli.fmu.packing import add_packing, add_settings, require_suffix, say_packed
from quiesce.cli.hil_tables import add_options, table_files
from quiesce.engine.bench import setting_options

if TYPE_CHECKING:
    from quiesce.fmu.library import Description

EPILOG = """examples:
  quiesce fmu controller --law phase -o controller.fmu
  quiesce fmu controller --board my_board.toml --law fuzzy --rules my.fis --fmi 3 -o mine.fmu
  quiesce fmu controller --plant my_plant.toml --law phase --pulses tuned/ -o mine.fmu

Inputs: each sensor in SI units, and whether its sample is fresh; measured currents; enable, estop,
fault_reset. Outputs: current and enable of each driver, and every word of telemetry. Parameters of
the controller are param.NAME; those that are live can be changed while it runs. Rules, pulses and
other tables are inside. docs/howto/co-simulate.md says how to join it to a model.
"""


def add_parser(actions: argparse._SubParsersAction) -> None:
    parser = actions.add_parser(
        "controller",
        help="the firmware itself, with its tables",
        description="Make an FMU of the controller: the firmware itself, bit for bit.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    add_controller(parser)
    add_packing(parser)
    parser.set_defaults(run=run)


def add_controller(parser: argparse.ArgumentParser) -> None:
    """What makes the controller."""
    parser.add_argument("--law", default="fuzzy", help="(%(default)s)")
    wired = parser.add_mutually_exclusive_group()
    wired.add_argument("--board", type=Path, metavar="FILE", help="sensors and dampers, TOML")
    wired.add_argument(
        "--plant", type=Path, metavar="FILE",
        help="one accelerometer, as this plant has it (else as parameters say)",
    )  # fmt: skip
    add_settings(parser)
    add_options(parser)


def run(args: argparse.Namespace) -> int:
    require_suffix(args.out)
    return say_packed(args.out, args.fmi, "controller", make(args, args.fmi, args.out))


def make(args: argparse.Namespace, fmi: str, out: Path) -> "Description":
    """Makes the FMU of those options."""
    from quiesce.fmu.pack import pack

    with tempfile.TemporaryDirectory(prefix="quiesce-fmu-") as folder:
        tables, tuned = table_files(args, Path(folder))
        files = {f"--{name}": file for name, file in tables.items()}
        for name in ("board", "plant"):
            if (file := getattr(args, name)) is not None:
                files[f"--{name}"] = file
        words = ["--law", args.law, *setting_options([*tuned, *args.set])]
        text = f"Controller of MR dampers, law {args.law}: the firmware itself."
        return pack("controller", words, files, fmi, text, out)
