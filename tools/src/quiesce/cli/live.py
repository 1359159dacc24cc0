"""`quiesce live`: a page on which a controller is seen and commanded."""

import argparse
import asyncio
import os
import sys
import tempfile
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from quiesce.base.errors import UsageError
from quiesce.base.extras import extra
from quiesce.base.paths import build_folder, is_installed
from quiesce.cli.can.bus_options import VARIABLE, add_bus_options, bus_of
from quiesce.cli.can.command import with_packages
from quiesce.cli.commission import add_structure, structure_by, whole
from quiesce.cli.hil_tables import OPTIONS, add_options, table_files

if TYPE_CHECKING:
    from quiesce.can.buses import Bus
    from quiesce.can.link import Link
    from quiesce.live.guide import Guide
    from quiesce.live.relay import Relay
    from quiesce.live.rig import RigDesk

EPILOG = """examples:
  quiesce live --bus socketcan:can0
  quiesce live --raw --bus slcan:/dev/ttyACM0@921600
  quiesce live --host 0.0.0.0 --bus socketcan:can0    from a phone; asks for the token it prints
  quiesce live --sim                                  no hardware: a rig in the computer
  quiesce live --sim my_plant.toml --law fuzzy --record quake.csv
  quiesce live --sim --target linux                   its controller is quiesced, started here
  quiesce live --sim --can slcan:/dev/ttyACM0,bitrate=1000000    a board of yours, a plant in here
  quiesce live --bus socketcan:can0 --commission press --max-current 2 --drive 0.1

Open the address that it prints. Any number of browsers may look, up to 16; one at a time holds
control and changes parameters. STOP (button, or the Esc key) sends the emergency stop from every
one of them. Without a token only this computer gets in. The page is plain HTTP: over a network
that you do not trust, leave --host alone and use 'ssh -L 8642:127.0.0.1:8642'. A bus is no
replacement for the emergency stop's own wire. Ctrl-C ends it; the controller goes on, but for one
of --sim, which ends with it. docs/howto/watch-a-controller.md explains the page,
docs/howto/rig-in-the-computer.md that rig. With --commission the page leads from an unknown
structure to a controller at work on it, step by step, as 'quiesce commission' does at a terminal,
and goes on with what either has begun in FOLDER (docs/howto/commission.md).
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
    parser.add_argument(
        "--record-folder", type=Path, default=Path("recordings"), metavar="FOLDER",
        help="where the page's recorder writes (%(default)s; made at the first recording)",
    )  # fmt: skip
    add_bus_options(parser)
    add_rig_options(parser)
    guide = parser.add_argument_group("guided session")
    guide.add_argument(
        "--commission", type=Path, metavar="FOLDER",
        help="lead a commissioning on the page; FOLDER has its state, recordings and report",
    )  # fmt: skip
    add_structure(guide)
    parser.set_defaults(run=with_packages(run))


def add_rig_options(parser: argparse.ArgumentParser) -> None:
    rig = parser.add_argument_group("rig in the computer, in place of a bus")
    rig.add_argument(
        "--sim", nargs="?", const="", metavar="PLANT",
        help="plant (TOML) and controller at the rate of the clock, to shake, disturb and command "
        "on the page (the plant that ships)",
    )  # fmt: skip
    rig.add_argument("--board", type=Path, metavar="FILE", help="what is wired to it, TOML")
    rig.add_argument("--law", metavar="NAME", help="of the firmware (phase)")
    add_options(rig)
    rig.add_argument(
        "--set", action="append", default=[], metavar="NAME=VALUE", help="parameter; repeatable"
    )
    rig.add_argument(
        "--target", choices=("host", "mps2", "linux"),
        help="where its controller runs: in the rig's own program (host, the default), as the "
        "image in the emulator, or as quiesced, started here, which runs by itself",
    )  # fmt: skip
    rig.add_argument(
        "--can", metavar="CHANNEL",
        help="in place of --target: what leads to a controller that runs already, such as a board "
        "(slcan:/dev/ttyACM0,bitrate=1000000, socketcan:can0); the plant is on its bus. It is not "
        "enabled by itself: a real coil gets real current",
    )  # fmt: skip
    rig.add_argument(
        "--record", type=Path, action="append", default=[], metavar="FILE",
        help="CSV of a ground motion to choose on the page; repeatable (all that lie beside the "
        "project, and one that ships)",
    )  # fmt: skip


def run(args: argparse.Namespace) -> int:
    from quiesce.can.database import load
    from quiesce.can.link import Link
    from quiesce.can.stopping import until_stopped

    if not 0 <= args.port <= 65535:
        raise UsageError(f"--port {args.port}: 0 .. 65535")
    given = token_of(args.token_file)
    known = known_of(args)
    plots = plots_folder()
    with extra("live", "quiesce live"):
        from quiesce.live.access import Policy, is_local, new_token
        from quiesce.live.desk import Desk
        from quiesce.live.room import Room
        from quiesce.live.server import listen, serve

    token = given or ("" if is_local(args.host) else new_token())
    with (
        until_stopped() as stop,
        listen(args.host, args.port) as at,
        watched(args) as (bus, rig),
        Link(bus, echoes=True) as link,
        guided(args, known, link, rig) as (relay, guide),
    ):
        print(f"{address(args.host, at.getsockname()[1], token)}  (Ctrl-C ends it)", flush=True)
        if not is_local(args.host):
            print("quiesce: plain HTTP: who listens on the way learns the token", file=sys.stderr)
        desk = Desk(link, load(), args.raw or rig is not None, args.record_folder, relay)
        asyncio.run(serve(Room(desk, rig, guide), Policy(args.host, token), plots, at, stop))
    return 0


def known_of(args: argparse.Namespace) -> dict[str, Any]:
    """Of the structure, for the guided session."""
    known = structure_by(args)
    if known and args.commission is None:
        raise UsageError(
            "what is known of the structure is for the guided session: give --commission FOLDER"
        )
    return known


@contextmanager
def guided(
    args: argparse.Namespace, known: dict[str, Any], link: "Link", rig: "RigDesk | None"
) -> "Iterator[tuple[Relay | None, Guide | None]]":
    """The guided session, and what joins it to a bus that only one program can have."""
    if args.commission is None:
        yield None, None
        return
    from quiesce.base.paths import default_plant
    from quiesce.live.guide import Guide, Plan
    from quiesce.live.relay import Relay, is_shared

    with ExitStack() as stack:
        relay = None if is_shared(link.bus) else stack.enter_context(Relay(link))
        simulation = None
        if rig is not None:
            simulation = rig.simulation
            known = {"plant": whole(Path(args.sim) if args.sim else default_plant()), **known}
        plan = Plan(args.commission.resolve(), known, link.bus, relay, simulation)
        yield relay, stack.enter_context(Guide(plan))


@contextmanager
def watched(args: argparse.Namespace) -> "Iterator[tuple[Bus, RigDesk | None]]":
    """The bus, and the rig in the computer that is on it where that is asked for."""
    if args.sim is None:
        refuse_rig_options(args)
        yield bus_of(args), None
        return
    if args.bus != os.environ.get(VARIABLE) or args.bitrate is not None or args.bus_option:
        raise UsageError("--sim makes a bus of its own; leave --bus and its options out")
    from quiesce.live.rig import RigDesk
    from quiesce.rig.opening import simulation_of
    from quiesce.rig.options import HOST, LAW, RigSetup
    from quiesce.rig.records import motions
    from quiesce.rig.simulation import bus_words, own_bus

    plant = Path(args.sim) if args.sim else None
    found, bus = motions(args.record), own_bus()
    with extra("multicast", "quiesce live --sim"):
        import msgpack  # noqa: F401
    with tempfile.TemporaryDirectory() as folder:
        tables, settings = table_files(args, Path(folder))
        setup = RigSetup(
            plant,
            args.board,
            args.law or LAW,
            (*settings, *args.set),
            [*tables.items()],
            args.target or HOST,
            args.can,
        )
        with simulation_of(setup, bus) as simulation:
            print(f"other commands join it with {bus_words(bus)}", file=sys.stderr)
            yield bus, RigDesk(simulation, found)


def refuse_rig_options(args: argparse.Namespace) -> None:
    for option in ("board", "law", *OPTIONS, "set", "record", "target", "can"):
        if getattr(args, option):
            raise UsageError(
                f"--{option.replace('_', '-')} is of the rig in the computer; give --sim, too"
            )


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
