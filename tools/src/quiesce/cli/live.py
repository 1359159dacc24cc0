"""`quiesce live`: a page on which a controller is seen and commanded."""

import argparse
import asyncio
import sys
from pathlib import Path

from quiesce.base.errors import UsageError
from quiesce.base.extras import extra
from quiesce.base.paths import build_folder, is_installed
from quiesce.cli.can.bus_options import add_bus_options, bus_of
from quiesce.cli.can.command import with_packages

EPILOG = """examples:
  quiesce live --bus socketcan:can0
  quiesce live --raw --bus slcan:/dev/ttyACM0@921600
  quiesce live --host 0.0.0.0 --bus socketcan:can0    from a phone; asks for the token it prints

Open the address that it prints. Any number of browsers may look, up to 16; one at a time holds
control and changes parameters. STOP (button, or the Esc key) sends the emergency stop from every
one of them. Without a token only this computer gets in. The page is plain HTTP: over a network
that you do not trust, leave --host alone and use 'ssh -L 8642:127.0.0.1:8642'. A bus is no
replacement for the emergency stop's own wire. Ctrl-C ends it; the controller goes on.
docs/howto/watch-a-controller.md explains the page.
"""

PORT = 8642
LEAST_TOKEN = 16


def add_parser(commands: argparse._SubParsersAction) -> None:
    parser = commands.add_parser(
        "live",
        description="Serve a page that shows and commands the controller on a bus.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument(
        "--host", default="127.0.0.1", metavar="ADDRESS",
        help="where to listen (%(default)s: this computer only); another one needs a token",
    )  # fmt: skip
    parser.add_argument(
        "--port", type=int, default=PORT, metavar="N", help="(%(default)s; 0: any that is free)"
    )
    parser.add_argument(
        "--token-file", type=Path, metavar="FILE",
        help=f"its first line, of {LEAST_TOKEN} letters or more, is the token (a new one)",
    )  # fmt: skip
    parser.add_argument(
        "--raw", action="store_true", help="every sample, too: asks for RawSample (+27 %% bus load)"
    )
    add_bus_options(parser)
    parser.set_defaults(run=with_packages(run))


def run(args: argparse.Namespace) -> int:
    from quiesce.can.database import load
    from quiesce.can.link import Link
    from quiesce.can.stopping import until_stopped

    if not 0 <= args.port <= 65535:
        raise UsageError(f"--port {args.port}: 0 .. 65535")
    given = token_of(args.token_file)
    bus, plots = bus_of(args), plots_folder()
    with extra("live", "quiesce live"):
        from quiesce.live.access import Policy, is_local, new_token
        from quiesce.live.desk import Desk
        from quiesce.live.server import listen, serve

    token = given or ("" if is_local(args.host) else new_token())
    with until_stopped() as stop, listen(args.host, args.port) as at, Link(bus) as link:
        print(f"{address(args.host, at.getsockname()[1], token)}  (Ctrl-C ends it)", flush=True)
        if not is_local(args.host):
            print("quiesce: plain HTTP: who listens on the way learns the token", file=sys.stderr)
        desk = Desk(link, load(), args.raw)
        asyncio.run(serve(desk, Policy(args.host, token), plots, at, stop))
    return 0


def token_of(file: Path | None) -> str:
    """Empty without a file. UsageError where it has none that will do."""
    if file is None:
        return ""
    lines = file.read_bytes().splitlines() or [b""]
    token = lines[0].strip()
    if len(token) < LEAST_TOKEN or not token.isascii() or not token.decode().isprintable():
        raise UsageError(
            f"--token-file {file}: its first line is to have {LEAST_TOKEN} printable letters or "
            "more, without any beyond ASCII"
        )
    return token.decode()


def address(host: str, port: int, token: str) -> str:
    name = f"[{host}]" if ":" in host else host
    return f"http://{name}:{port}/" + (f"#token={token}" if token else "")


def plots_folder() -> Path:
    """The folder with uPlot. UsageError where it is missing."""
    folder = build_folder() / "deps/uplot"
    if not (folder / "uPlot.iife.min.js").is_file():
        how = "it is no part of this package" if is_installed() else "./tools/setup page fetches it"
        raise UsageError(f"uPlot, which draws the page, is missing: {how}")
    return folder
