"""`quiesce firmware info FILE`: what an image says of itself."""

import argparse
import json
from pathlib import Path

from quiesce.firmware.image import Image, read_image

EPILOG = """examples:
  quiesce firmware info build/firmware/nucleo_f446re/quiesce_nucleo_f446re-0.1.0.hex
  quiesce firmware info read_back.bin --json

FILE: .elf, .hex, .bin, .signed.bin, or what a debugger has read out of flash.
"""


def add_parser(actions: argparse._SubParsersAction) -> None:
    parser = actions.add_parser(
        "info",
        help="board, version, tables and seal of an image",
        description="Show what an image says of itself.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("file", metavar="FILE", type=Path)
    parser.add_argument("--json", action="store_true", help="one JSON object")
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    image = read_image(args.file)
    if args.json:
        print(json.dumps(description(image), indent=2))
        return 0
    print(f"board      {image.board}")
    print(f"version    {image.version_text}")
    print(f"at         0x{image.begin:08X}, {len(image.payload):,} bytes")
    print(f"params     layout 0x{image.param_layout:08X}")
    for one in image.tables:
        print(f"table      {one.kind}, {one.words} words, CRC-32 0x{one.crc:08X}")
    if not image.tables:
        print("tables     those that ship, none linked in")
    print(f"seal       {seal_text(image)}")
    return 0


def seal_text(image: Image) -> str:
    if not image.is_sealed:
        return "none: as compiled; `quiesce firmware build` seals"
    return f"{image.seal.hex()}, {'whole' if image.is_whole else 'BROKEN: not of this image'}"


def description(image: Image) -> dict:
    return {
        "board": image.board,
        "version": image.version_text,
        "begin": image.begin,
        "bytes": len(image.payload),
        "param_layout": image.param_layout,
        "tables": [vars(one) for one in image.tables],
        "seal": image.seal.hex() if image.is_sealed else None,
        "is_whole": image.is_whole,
    }
