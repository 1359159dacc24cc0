"""`quiesce can update FOLDER`: another program into a controller at work."""

import argparse
import json
import time
from pathlib import Path
from typing import Any

from quiesce.base.paths import shown
from quiesce.cli.can.bus_options import add_bus_options, bus_of
from quiesce.cli.can.table_options import Telling, add_json, step

EPILOG = """examples:
  quiesce can update build/firmware/nucleo_f446re --bus slcan:/dev/ttyACM0@1000000
  quiesce can update release --key maker_public.pem --at-least 0.1.0 --bus socketcan:can0

FOLDER: of `quiesce firmware build`, verified first as `quiesce firmware verify` does; an image that
is older than the one that runs is refused unless --at-least names an older version. The board has
to have been flashed with its .updatable.bin once.

The image goes into the place that does not run. It is refused while the controller is armed, and
nothing can be armed until it is over. The controller restarts, runs the new image on trial, and
goes back to the one before unless the new one has run for 2 s without a fault of the processor and
has answered this command. Cut off anywhere, it runs the one before. Untested on hardware.
Exit codes: 1 the controller refused, did not answer or went back; 2 no such image, nothing sent.
"""


def add_parser(commands: argparse._SubParsersAction) -> None:
    from quiesce.cli.firmware.verify import AT_LEAST, KEY

    parser = commands.add_parser(
        "update",
        help="another program, tried once and gone back from unless it works",
        description="Bring another image to a controller at work, over its bus.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("folder", type=Path, metavar="FOLDER")
    parser.add_argument("--key", **KEY)
    parser.add_argument("--at-least", **AT_LEAST)
    parser.add_argument("--dry-run", action="store_true", help="verify and ask, change nothing")
    add_json(parser)
    add_bus_options(parser)
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    from quiesce.can.database import load
    from quiesce.can.images import Images
    from quiesce.can.link import Link
    from quiesce.cli.firmware.verify import version_of
    from quiesce.loading.updating import Wanted, image_for, runs_already, update

    least = None if args.at_least is None else version_of(args.at_least)
    wanted = Wanted(args.folder, args.key, least)
    begin_s = time.monotonic()
    with Link(bus_of(args)) as link:
        images = Images(link, load())
        before = images.running()
        image = image_for(before, wanted)
        is_there = runs_already(before, args.folder)
        if not (args.dry_run or is_there):
            update(images, before, image, step, Telling().tell)
    report: dict[str, Any] = {
        "folder": shown(args.folder),
        "board": image.board,
        "from": ".".join(map(str, before.version)),
        "to": image.version_text,
        "place": 1 - before.slot,
        "bytes": len(image.payload),
        "took_s": round(time.monotonic() - begin_s, 1),
        "is_there": is_there,
        "is_updated": not (args.dry_run or is_there),
    }
    print(json.dumps(report, indent=1) if args.json else text(report, args.dry_run))
    return 0


def text(report: dict[str, Any], is_dry: bool) -> str:
    if report["is_there"]:
        return f"runs    {report['board']} {report['to']} already; nothing was changed"
    what = f"{report['board']} {report['from']} -> {report['to']}, {report['bytes']:,} bytes"
    if is_dry:
        return f"would   {what}; nothing was changed"
    return f"runs    {what}, after {report['took_s']:.1f} s; confirmed"
