"""`quiesce fmu damper`: a damper's model as an FMU."""

import argparse
from pathlib import Path

from quiesce.cli.fmu.packing import add_packing, packed

EPILOG = """examples:
  quiesce fmu damper build/identify/example/best.toml -o damper.fmu
  quiesce fmu damper sim_hil/data/dampers/spencer_prototype.toml --fmi 3 -o damper.fmu

Inputs: stroke_m, velocity_m_s and current_cmd_A (or command_V), which goes through the coil's lag
where the file has one. Output: force_N; > 0 resists a stroke that grows. Parameter force_factor
makes a stronger or weaker one of it, also while it runs.
"""


def add_parser(actions: argparse._SubParsersAction) -> None:
    parser = actions.add_parser(
        "damper",
        help="a damper's model alone",
        description="Make an FMU of a damper's model, for a structure of your own.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("damper", type=Path, metavar="DAMPER.toml")
    add_packing(parser)
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    text = f"MR damper {args.damper.stem}: resisting force over stroke, velocity and command."
    return packed(args, "damper", [], {"--damper": args.damper}, text)
