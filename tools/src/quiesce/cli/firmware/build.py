"""`quiesce firmware build BOARD`: an image for a board, with all that goes with it."""

import argparse
import sys
from pathlib import Path

from quiesce.base.atomic import output_files
from quiesce.base.errors import UsageError
from quiesce.base.paths import results_folder, results_text, shown
from quiesce.firmware.making import compiler_version, make
from quiesce.firmware.release import write_release
from quiesce.firmware.sizes import sizes_of

EPILOG = """examples:
  quiesce firmware build nucleo_f446re
  quiesce firmware build nucleo_f446re --table my_rules.table --key maker.pem --out release

Written: ELF, Intel HEX and bare bytes, sealed with their SHA-256, which the board checks at its
start; the same in the signed container of MCUboot's imgtool; boot code with the image, for boards
that are updated over the bus (.updatable.bin, flashed once), and what `quiesce can update` brings
them (.update); map, sizes, parts (CycloneDX), how to flash it, SHA256SUMS. The same sources and
compiler give the same bytes in any folder.

--table links tables in, in the place of those that ship (`quiesce rules compile --controller`, law,
tune). Without --key the container holds a hash and no signature: damage is found, a maker is not
proven. No boot loader looks at either.
"""


def add_parser(actions: argparse._SubParsersAction) -> None:
    parser = actions.add_parser(
        "build",
        help="compile, seal and sign an image",
        description="Compile a board's image, seal it, sign it.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("board", metavar="BOARD", help="of targets/stm32f4/boards")
    parser.add_argument(
        "--table", type=Path, action="append", default=[], metavar="FILE", help="to be linked in"
    )
    parser.add_argument("--key", type=Path, metavar="FILE", help="private ed25519 key, PEM")
    parser.add_argument(
        "--out", type=Path, metavar="DIR",
        help=f"folder to write to ({results_text('firmware/BOARD')}); an empty one, or of a build",
    )  # fmt: skip
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    made = make(args.board, args.table, say)
    if sys.stderr.isatty():
        print(file=sys.stderr)
    out = args.out or results_folder() / "firmware" / args.board
    empty(out)
    with output_files(out) as folder:
        image = write_release(made, args.key, compiler_version(), folder)
    sizes = sizes_of(made.whole)
    print(f"image      {image.board} {image.version_text}, {len(image.payload):,} bytes")
    print(f"memory     flash {sizes.flash:,}, RAM {sizes.ram:,} bytes")
    for one in image.tables:
        print(f"table      {one.kind}, {one.words} words, CRC-32 0x{one.crc:08X}")
    print(f"seal       {image.seal.hex()}")
    print(f"signed     {'by ' + shown(args.key) if args.key else 'no: a hash alone; --key signs'}")
    print(f"written    {shown(out)}")
    return 0


def say(how_far: str) -> None:
    """Where somebody looks."""
    if sys.stderr.isatty():
        print(f"\r{how_far}  ", end="", file=sys.stderr, flush=True)


def empty(out: Path) -> None:
    """Files of an earlier build go; UsageError where others are in the folder."""
    if not out.is_dir():
        return
    sums = out / "SHA256SUMS"
    files = [file for file in out.iterdir() if file.name != sums.name]
    known = sums.read_text(encoding="utf-8", errors="replace") if sums.is_file() else ""
    others = [file.name for file in files if f"  {file.name}\n" not in known]
    if others:
        raise UsageError(f"--out {out}: has {others[0]}, which is of no build; name another folder")
    for file in [*files, sums]:
        file.unlink(missing_ok=True)
