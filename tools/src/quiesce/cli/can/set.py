"""`quiesce can set NAME=VALUE...`: parameters of a controller at work."""

import argparse
import sys

from quiesce.cli.can.bus_options import add_bus_options, bus_of

EPILOG = """examples:
  quiesce can set law=phase --bus socketcan:can0
  quiesce can set law=constant constant_current_mA=1500 --save --bus slcan:/dev/ttyACM0

All values go into effect together, or none: they are staged, applied (the controller goes to its
safe current, then starts from rest), read back and compared with the hash that it reports. Where
anything fails, what was staged is discarded. --save keeps them for the next start, too.
Exit codes: 1 the controller refused or did not answer, 2 a value that is not allowed.
"""


def add_parser(commands: argparse._SubParsersAction) -> None:
    parser = commands.add_parser(
        "set",
        help="change parameters, checked by reading back",
        description="Change parameters of the controller, all of them or none.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("settings", nargs="+", metavar="NAME=VALUE")
    parser.add_argument("--save", action="store_true", help="keep them for the next start")
    add_bus_options(parser)
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    from quiesce.can.changes import apply, save, verify
    from quiesce.can.database import load
    from quiesce.can.link import Link
    from quiesce.can.parameters import name_of, parameters, settings_of, text_of
    from quiesce.can.services import Services

    settings = settings_of(args.settings)
    with Link(bus_of(args)) as link:
        services = Services(link, load())
        before = services.read_all()
        apply(services, settings)
        verify(services, before, settings)
        for index, value in settings.items():
            one = parameters()[index]
            print(f"{name_of(index)}: {text_of(one, before[index])} -> {text_of(one, value)}")
        if args.save:
            save(services)
            print("stored for the next start", file=sys.stderr)
    return 0
