"""`quiesce firmware flash PLACE --with TOOL`: verified, then onto the board."""

import argparse
import shutil
import subprocess
import tempfile
from pathlib import Path

from quiesce.base.errors import EXIT_FAILED, UsageError
from quiesce.cli.firmware.verify import add_options, refused
from quiesce.firmware.container import payload_of
from quiesce.firmware.flashing import WAYS, line
from quiesce.firmware.image import image_of, read_bytes
from quiesce.firmware.release import SIGNED, signed_file

EPILOG = """examples:
  quiesce firmware flash build/firmware/nucleo_f446re --with openocd --dry-run
  quiesce firmware flash build/firmware/nucleo_f446re --with openocd --board nucleo_f446re

Verified first, as `quiesce firmware verify` does; what is refused is not flashed. The coil's supply
off, until the board has started. What is kept on the board (parameters, tables) stays.
Untested on hardware.
"""


def add_parser(actions: argparse._SubParsersAction) -> None:
    parser = actions.add_parser(
        "flash",
        help="verify an image, then write it to the board",
        description="Verify an image, then write it to the board by a tool that is installed.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    add_options(parser)
    parser.add_argument("--with", dest="tool", choices=tuple(WAYS), required=True)
    parser.add_argument("--dry-run", action="store_true", help="verify, print the command")
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    why = refused(args)
    if why:
        print(f"refused    {why}")
        return EXIT_FAILED
    file = signed_file(args.place)
    image = image_of(payload_of(read_bytes(file)), file)
    with tempfile.TemporaryDirectory() as name:
        bare = Path(name) / file.name.replace(SIGNED, ".bin")
        bare.write_bytes(image.payload)
        command = WAYS[args.tool].command(bare, image.begin)
        if args.dry_run:
            print(line(WAYS[args.tool].command(Path(bare.name), image.begin)))
            return 0
        if shutil.which(command[0]) is None:
            raise UsageError(f"{args.tool} is not installed; install it, or name another --with")
        print(f"{image.board} {image.version_text}: {line(command)}", flush=True)
        done = subprocess.run(command)
    if done.returncode != 0:
        print(f"failed     {args.tool} ended with {done.returncode}; the board may have half of it")
        return EXIT_FAILED
    return 0
