"""`quiesce fmu plant`: the simulated plant as an FMU."""

import argparse
from pathlib import Path

from quiesce.base.command import real_number, whole_number
from quiesce.base.errors import UsageError
from quiesce.cli.fmu.packing import add_packing, add_settings, packed
from quiesce.engine.bench import setting_options

EPILOG = """examples:
  quiesce fmu plant my_plant.toml -o plant.fmu
  quiesce fmu plant my_plant.toml --board my_board.toml --fmi 3 -o plant.fmu
  quiesce fmu plant --scenario sim_hil/data/scenarios/sine_10Hz.toml -o plant.fmu

Inputs: what each damper's driver is told; without a scenario also the shaker's force and, where
the plant has one, the acceleration of its base. Outputs: what the sensors of plant or board
deliver, and the truth. With a scenario what shakes it is inside. Its tick is the controller's:
--set tick_rate_Hz=N.
"""


def add_parser(actions: argparse._SubParsersAction) -> None:
    parser = actions.add_parser(
        "plant",
        help="structure, dampers, drivers and sensors",
        description="Make an FMU of a plant: structure, dampers, drivers and sensors.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("plant", type=Path, nargs="?", metavar="PLANT.toml")
    parser.add_argument("--scenario", type=Path, metavar="FILE", help="with what shakes it, TOML")
    parser.add_argument("--board", type=Path, metavar="FILE", help="sensors and dampers, TOML")
    parser.add_argument(
        "--seed", type=whole_number(0, 2**31 - 1), metavar="N", help="of the sensors' noise"
    )
    parser.add_argument(
        "--noise-mg", type=real_number(0.0, 1e4), metavar="RMS", help="of its own accelerometer"
    )
    parser.add_argument(
        "--dt-us", type=real_number(1.0, 2000.0), metavar="US", help="longest integration step"
    )
    add_settings(parser)
    add_packing(parser)
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    if args.plant is None and args.scenario is None:
        raise UsageError("name a plant, or --scenario, which has one")
    named = {"--plant": args.plant, "--scenario": args.scenario, "--board": args.board}
    files = {option: file for option, file in named.items() if file is not None}
    words = ["--law", "off", *setting_options(args.set)]
    for name in ("seed", "noise_mg", "dt_us"):
        if (value := getattr(args, name)) is not None:
            words += [f"--{name.replace('_', '-')}", f"{value:g}" if name != "seed" else str(value)]
    shaken = f", shaken by {args.scenario.stem}" if args.scenario else ""
    text = f"Plant {(args.plant or args.scenario).stem} with MR dampers{shaken}."
    return packed(args, "plant", words, files, text)
