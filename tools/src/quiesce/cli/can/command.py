"""`quiesce can ACTION`: the CAN interface from a computer. One module an action."""

import argparse
from collections.abc import Callable

from quiesce.base.errors import UsageError
from quiesce.cli.can import (
    bus_load,
    check,
    decode,
    fetch,
    forget_learnt,
    freeze,
    get,
    list,
    load,
    monitor,
    record,
    replay,
    restore_learnt,
    revert,
    save_learnt,
    set,
    stop,
    tables,
    update,
)

# Import name and package.
PACKAGES = {
    "can": "python-can",
    "cantools": "cantools",
    "asammdf": "asammdf",
    "serial": "pyserial",
    "msgpack": "msgpack",
    "isotp": "can-isotp",
}

# Each has add_parser(subparsers), like the commands; its own parser sets `run`.
ACTIONS = (
    list,
    decode,
    monitor,
    check,
    record,
    replay,
    get,
    set,
    stop,
    freeze,
    load,
    tables,
    revert,
    fetch,
    save_learnt,
    restore_learnt,
    forget_learnt,
    update,
    bus_load,
)

EPILOG = """examples:
  quiesce can list
  quiesce can monitor --bus socketcan:can0
  quiesce can record --out run.mf4 --bus slcan:/dev/ttyACM0
  quiesce can decode run.mf4 --only Status
  quiesce can set law=phase --save --bus slcan:socket://127.0.0.1:5556
  quiesce can stop --bus socketcan:can0
  quiesce can freeze --bus socketcan:can0
  quiesce can load rules mine.fis --bus socketcan:can0

The messages are those of firmware/comm/quiesce.dbc; docs/howto/use-can-tools.md has an example of
each. 'quiesce can ACTION --help' has the options of one.
"""


def add_parser(commands: argparse._SubParsersAction) -> None:
    parser = commands.add_parser(
        "can",
        description="The CAN interface over any bus that python-can has a driver for.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    actions = parser.add_subparsers(metavar="ACTION", required=True)
    for action in ACTIONS:
        action.add_parser(actions)
    for one in actions.choices.values():
        one.set_defaults(run=with_packages(one.get_default("run")))


def with_packages(run: Callable[[argparse.Namespace], int]) -> Callable[[argparse.Namespace], int]:
    """UsageError where one of the packages that only these actions need is not installed."""

    def checked(args: argparse.Namespace) -> int:
        try:
            return run(args)
        except ModuleNotFoundError as error:
            if error.name not in PACKAGES:
                raise
            package = PACKAGES[error.name]
            raise UsageError(
                f"the Python package {package} is not installed; './tools/setup python' installs "
                "all that tools/requirements.txt names"
            )

    return checked
