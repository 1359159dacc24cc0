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
from quiesce.firmware.image import FLASH_BEGIN, Image, image_of, read_bytes
from quiesce.firmware.release import SIGNED, UPDATABLE, UPDATABLE_SIGNED, signed_file

EPILOG = """examples:
  quiesce firmware flash build/firmware/nucleo_f446re --with openocd --dry-run
  quiesce firmware flash build/firmware/nucleo_f446re --with openocd --board nucleo_f446re

Verified first, as `quiesce firmware verify` does; what is refused is not flashed. The coil's supply
off, until the board has started. What is kept on the board (parameters, tables) stays.
--updatable flashes boot code with the image, after which `quiesce can update` brings others.
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
    parser.add_argument("--updatable", action="store_true", help="with boot code; of a folder")
    parser.add_argument("--dry-run", action="store_true", help="verify, print the command")
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    ending = UPDATABLE_SIGNED if args.updatable else SIGNED
    if args.updatable and not args.place.is_dir():
        raise UsageError(f"--updatable: {args.place} is a file; name the folder of a build")
    why = refused(args, ending)
    if why:
        print(f"refused    {why}")
        return EXIT_FAILED
    image, data = what_to_flash(args.place, ending)
    if data == image.payload and image.begin != FLASH_BEGIN:
        raise UsageError(
            f"{args.place.name}: linked for 0x{image.begin:08X}, behind boot code; bring it by "
            "`quiesce can update`, or flash the folder with --updatable"
        )
    with tempfile.TemporaryDirectory() as name:
        bare_ending = UPDATABLE if args.updatable else ".bin"
        bare = Path(name) / f"quiesce_{image.board}-{image.version_text}{bare_ending}"
        bare.write_bytes(data)
        command = WAYS[args.tool].command(bare, FLASH_BEGIN)
        if args.dry_run:
            print(line(WAYS[args.tool].command(Path(bare.name), FLASH_BEGIN)))
            return 0
        if shutil.which(command[0]) is None:
            raise UsageError(f"{args.tool} is not installed; install it, or name another --with")
        print(f"{image.board} {image.version_text}: {line(command)}", flush=True)
        done = subprocess.run(command)
    if done.returncode != 0:
        print(f"failed     {args.tool} ended with {done.returncode}; the board may have half of it")
        return EXIT_FAILED
    return 0


def what_to_flash(place: Path, ending: str) -> tuple[Image, bytes]:
    """The image, and all that goes from FLASH_BEGIN on: what the container has."""
    file = signed_file(place, ending)
    data = payload_of(read_bytes(file))
    return image_of(data, file), data
