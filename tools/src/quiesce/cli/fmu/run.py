"""`quiesce fmu run PLANT.fmu`: the controller on somebody else's plant."""

import argparse
import tempfile
import time
from pathlib import Path
from typing import TYPE_CHECKING

from quiesce.base.atomic import output_files
from quiesce.base.command import real_number
from quiesce.base.errors import UsageError
from quiesce.base.paths import results_folder, results_text, shown
from quiesce.base.progress import say
from quiesce.base.table import format_table
from quiesce.cli.fmu import controller
from quiesce.cli.terminal import show

if TYPE_CHECKING:
    from quiesce.fmu.cosim import Run

EPILOG = """examples:
  quiesce fmu run my_plant.fmu --law phase --wire sensor.accel_m_s2=seat_acc \\
      --wire F_coil_A=damper.current_cmd_A --seconds 20
  quiesce fmu run plant.fmu --board my_board.toml --law fuzzy --start seed=3

The plant is any FMU for co-simulation (2.0 or 3.0) for this machine. Inputs are joined to outputs
of the same name; others by --wire INPUT=OUTPUT, with *FACTOR and +OFFSET where units differ.
Inputs of the plant that nothing is joined to keep their start values. Both run in lock-step, a tick
of the controller at a time; its currents act one tick after their sample, as in the bench.
--compare runs the plant once more by itself, nothing joined to its inputs, and says what the
controller changed.

An FMU is native code that runs with your rights: run those that you trust.
Written: run.csv and run.png.
"""

SAY_EVERY_s = 2.0


def add_parser(actions: argparse._SubParsersAction) -> None:
    parser = actions.add_parser(
        "run",
        help="the controller on somebody else's plant",
        description="Run the controller on a plant that is an FMU, in lock-step.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("file", type=Path, metavar="PLANT.fmu")
    controller.add_controller(parser)
    parser.add_argument(
        "--wire", action="append", default=[], metavar="INPUT=OUTPUT", help="repeatable"
    )
    parser.add_argument(
        "--start", action="append", default=[], metavar="NAME=VALUE",
        help="start value of the plant's, repeatable",
    )  # fmt: skip
    parser.add_argument(
        "--seconds", type=real_number(0.01, 1e5), default=10.0, metavar="S", help="(%(default)s)"
    )
    parser.add_argument(
        "--keep", action="append", default=[], metavar="OUTPUT",
        help="in run.csv and run.png, repeatable (numbers of the plant, currents, frequency, RMS)",
    )  # fmt: skip
    parser.add_argument("--compare", action="store_true", help="run it without the controller, too")
    parser.add_argument(
        "--out", type=Path, metavar="DIR", help=f"folder to write to ({results_text('fmu/PLANT')})"
    )
    parser.set_defaults(run=run)


def start_values(texts: list[str]) -> dict[str, float]:
    """UsageError where one is not NAME=NUMBER."""
    values = {}
    for text in texts:
        name, _, number = text.partition("=")
        try:
            values[name] = float({"true": "1", "false": "0"}.get(number, number))
        except ValueError:
            raise UsageError(f"--start {text}: expected NAME=VALUE, a number") from None
    return values


def run(args: argparse.Namespace) -> int:
    from quiesce.fmu.cosim import write_csv
    from quiesce.fmu.figures import compared, plot

    if not args.file.is_file():
        raise UsageError(f"{shown(args.file)}: there is no such file; name an FMU")
    with tempfile.TemporaryDirectory(prefix="quiesce-fmu-") as folder:
        made = Path(folder) / "controller.fmu"
        tick_s = controller.make(args, "2", made).tick_s
        done = closed_loop(args, made, tick_s)
        before = closed_loop(args, made, tick_s, is_off=True) if args.compare else None
    out = args.out or results_folder() / "fmu" / args.file.stem
    with output_files(out) as staging:
        write_csv(staging / "run.csv", done)
        plot(staging / "run.png", done, before, f"{args.file.stem}, law {args.law}")
    show(format_table(*compared(done, before), left=(0,)))
    print(f"{shown(out)}: run.csv, run.png")
    return 0


def closed_loop(args: argparse.Namespace, made: Path, tick_s: float, is_off: bool = False) -> "Run":
    from quiesce.fmu import cosim
    from quiesce.fmu.slave import Slave

    wires = dict(cosim.parse_wire(text) for text in args.wire)
    starts = start_values(args.start)
    with Slave(args.file, starts, args.seconds) as plant, Slave(made, {}, args.seconds) as loop:
        for name in args.keep:
            if name not in plant.names("output"):
                loop.variable(name)
        return cosim.run(
            plant,
            loop,
            wires,
            tick_s,
            max(1, round(args.seconds / tick_s)),
            args.keep or cosim.usual_columns(plant, loop),
            is_off,
            Told(args.seconds, tick_s),
        )


class Told:
    """Says every few seconds how far it is."""

    def __init__(self, seconds: float, tick_s: float) -> None:
        self._seconds = seconds
        self._tick_s = tick_s
        self._next_s = time.monotonic() + SAY_EVERY_s

    def __call__(self, tick: int) -> None:
        if time.monotonic() >= self._next_s:
            self._next_s += SAY_EVERY_s
            say(f"{tick * self._tick_s:.1f} of {self._seconds:g} s")
