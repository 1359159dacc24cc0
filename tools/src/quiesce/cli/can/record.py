"""`quiesce can record`: the bus into log files."""

import argparse
import math
import sys
import time
from pathlib import Path
from typing import Any

from quiesce.base.command import finite_number
from quiesce.base.errors import EXIT_FAILED, UsageError
from quiesce.base.paths import shown
from quiesce.cli.can.bus_options import add_bus_options, bus_of
from quiesce.cli.can.options import check_seconds

EPILOG = """examples:
  quiesce can record --out run.blf --bus socketcan:can0
  quiesce can record --out run.mf4 --seconds 60 --bus slcan:/dev/ttyACM0
  quiesce can record --out raw.blf --raw --bus slcan:/dev/ttyACM0@921600
  quiesce can record --out long.asc --rotate-mb 100 --rotate-s 3600 --bus socketcan:can0

The suffix chooses the format: .log (candump), .asc, .blf, .csv or .mf4. Every file begins with the
controller's Identification and all its parameters as ServiceReply frames; .mf4 also carries the
DBC and the parameters as attached files. With rotation: run_0001.blf, run_0002.blf ...
Ctrl-C and SIGTERM end it, with complete files. A bus that is lost is opened again; the gap is a
comment in .asc and .mf4, a marker in .blf. On a full disk what was written stays readable.
CAN FD frames go into every format but .csv.
Exit codes: 1 the disk was full, an .mf4 could not be made, or a format could not hold some frame
(.csv: CAN FD; .mf4: remote and error frames, which stay in NAME.mf4.log); 2 bad input.
"""

FORMATS = (".log", ".asc", ".blf", ".csv", ".mf4")
TELL_S = 5.0


def add_parser(commands: argparse._SubParsersAction) -> None:
    parser = commands.add_parser(
        "record",
        help="the bus into ASC, BLF, candump, CSV or MDF4 files",
        description="Record everything on the bus.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--out", type=Path, required=True, metavar="FILE")
    parser.add_argument(
        "--seconds", type=finite_number, metavar="T", help="how long (until Ctrl-C)"
    )
    parser.add_argument(
        "--rotate-mb", type=finite_number, metavar="X",
        help="next file at this size (of .mf4: while it is written, uncompressed)",
    )  # fmt: skip
    parser.add_argument("--rotate-s", type=finite_number, metavar="T", help="next file at this age")
    parser.add_argument(
        "--raw", action="store_true", help="every sample, too: asks for RawSample (+27 %% bus load)"
    )
    parser.add_argument(
        "--listen", action="store_true", help="send nothing: no parameters in the log"
    )
    add_bus_options(parser)
    parser.set_defaults(run=run)


def check(args: argparse.Namespace) -> None:
    if args.out.suffix.lower() not in FORMATS:
        raise UsageError(f"--out {args.out}: its suffix chooses the format: {', '.join(FORMATS)}")
    for option, value in (("--seconds", args.seconds), ("--rotate-s", args.rotate_s)):
        if value is not None:
            check_seconds(option, value)
    if args.raw and args.listen:
        raise UsageError("--raw asks the controller, --listen sends nothing: choose one")
    if args.rotate_mb is not None and not (
        math.isfinite(args.rotate_mb) and args.rotate_mb >= 0.01
    ):
        raise UsageError(f"--rotate-mb {args.rotate_mb:g}: at least 0.01")


def say(text: str) -> None:
    print(f"quiesce: {text}", file=sys.stderr, flush=True)


def run(args: argparse.Namespace) -> int:
    from quiesce.can.database import load
    from quiesce.can.link import Link
    from quiesce.can.mdf import require_mdf
    from quiesce.can.recorder import Plan, Recorder, open_first
    from quiesce.can.stopping import until_stopped

    check(args)
    if args.out.suffix.lower() == ".mf4":
        require_mdf()
    size = None if args.rotate_mb is None else int(args.rotate_mb * 1e6)
    plan = Plan(args.out, size, args.rotate_s, not args.listen, args.raw)
    bus, database = bus_of(args), load()
    with until_stopped() as stop, Link(bus, echoes=True) as link:
        recorder = Recorder(link, database, plan, say)
        open_first(recorder)
        start_s = time.monotonic()

        def tell() -> None:
            seen = recorder.traffic
            rate_Hz = seen.frames / (time.monotonic() - start_s)
            print(
                f"{shown(recorder.file.path)}: {seen.frames} frames, {rate_Hz:.0f}/s, "
                f"{seen.total('lost')} lost, {seen.total('wrong_crc')} wrong CRC",
                file=sys.stderr,
                flush=True,
            )

        print(f"recording {bus.name}; Ctrl-C ends it", file=sys.stderr, flush=True)
        try:
            recorder.run(stop, args.seconds, TELL_S, tell)
        finally:
            report(recorder, link)
    return EXIT_FAILED if any(file.failure for file in recorder.files) else 0


def report(recorder: Any, link: Any) -> None:
    from quiesce.can.traffic import summary_line

    for file in recorder.files:
        count = "cut where the disk was full" if file.error else f"{file.frames} frames"
        print(f"{shown(file.result)}: {count}")
    noise = f", {link.malformed} malformed lines" if link.malformed else ""
    print(summary_line(recorder.traffic.summary()) + noise, file=sys.stderr)
