"""`quiesce firmware verify PLACE`: whether an image may be flashed."""

import argparse
import re
from pathlib import Path

from quiesce.base.errors import EXIT_FAILED, UsageError
from quiesce.base.paths import shown
from quiesce.firmware.release import SIGNED, refusal

EPILOG = """examples:
  quiesce firmware verify build/firmware/nucleo_f446re
  quiesce firmware verify quiesce_nucleo_f446re-0.1.0.signed.bin --key maker_public.pem \\
      --board nucleo_f446re --at-least 0.1.0

Looked at: the folder's SHA256SUMS, the container's hash and, with --key, its signature, the image's
seal, its board, its version. Exit code 1 where one of them is wrong, with what.
"""


KEY = {"type": Path, "metavar": "FILE", "help": "the maker's public key, PEM"}
AT_LEAST = {"metavar": "X.Y.Z", "help": "the oldest version allowed"}


def add_parser(actions: argparse._SubParsersAction) -> None:
    parser = actions.add_parser(
        "verify",
        help="may this image be flashed?",
        description="Say whether an image is whole, of its maker, for a board, and new enough.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    add_options(parser)
    parser.set_defaults(run=run)


def add_options(parser: argparse.ArgumentParser) -> None:
    """Of what is verified."""
    parser.add_argument("place", metavar="PLACE", type=Path, help="signed image, or its folder")
    parser.add_argument("--key", **KEY)
    parser.add_argument("--board", metavar="NAME", help="the board that it has to be for")
    parser.add_argument("--at-least", **AT_LEAST)


def run(args: argparse.Namespace) -> int:
    why = refused(args)
    if why:
        print(f"refused    {why}")
        return EXIT_FAILED
    print(f"good       {shown(args.place)}: whole{', signed' if args.key else ''}")
    if not args.key:
        print("           who made it is not known: --key asks for a signature")
    return 0


def refused(args: argparse.Namespace, ending: str = SIGNED) -> str:
    """ending: of what is meant, in a folder."""
    least = None if args.at_least is None else version_of(args.at_least)
    return refusal(args.place, args.key, args.board, least, ending)


def version_of(text: str) -> tuple[int, int, int]:
    if not re.fullmatch(r"\d{1,5}\.\d{1,5}\.\d{1,5}", text):
        raise UsageError(f"--at-least {text}: no version; name one as 0.1.0")
    major, minor, patch = (int(part) for part in text.split("."))
    return major, minor, patch
