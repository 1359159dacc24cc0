"""`quiesce firmware key PRIVATE PUBLIC`: a pair of keys to sign images with."""

import argparse
from pathlib import Path

from quiesce.base.paths import shown
from quiesce.firmware.container import make_keys

EPILOG = """example:
  quiesce firmware key maker.pem maker_public.pem

Who has the private one makes images that others take for yours: it belongs in no repository. The
public one goes to whoever verifies.
"""


def add_parser(actions: argparse._SubParsersAction) -> None:
    parser = actions.add_parser(
        "key",
        help="make a pair of keys",
        description="Make a pair of ed25519 keys (PEM). Files that exist are not written over.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("private", metavar="PRIVATE", type=Path)
    parser.add_argument("public", metavar="PUBLIC", type=Path)
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    make_keys(args.private, args.public)
    print(f"written    {shown(args.private)}, {shown(args.public)}")
    return 0
