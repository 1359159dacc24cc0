"""`quiesce commission FOLDER`: from an unknown structure to a verified controller at work."""

import argparse
import sys
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from quiesce.base.command import real_number, whole_number
from quiesce.base.errors import EXIT_INTERRUPTED, UsageError
from quiesce.base.paths import shown
from quiesce.base.progress import say
from quiesce.base.table import format_table
from quiesce.cli.can.bus_options import add_bus_options, bus_of
from quiesce.cli.can.command import with_packages

if TYPE_CHECKING:
    from quiesce.commission.folder import Folder
    from quiesce.commission.site import Site
    from quiesce.commission.wants import Wants

STEPS = (
    "wiring", "calibrate", "excite", "find", "damper", "tune", "load", "verify", "report",
)  # fmt: skip

EPILOG = """steps, in this order
  wiring     is everything connected, and the right way round? a small current, for a moment
  calibrate  the accelerometer turned over: axis, offset, gain; shaken: does it sit fast?
  excite     a first look, then a sweep at 0 A and dwells with steps of the current
  find       the plant in that recording
  damper     the one that was found, or --damper: a file of 'quiesce identify'
  tune       pulses of current, what they promise, and the best that any current could do
  load       pulses and parameters into the controller, checked by it, kept
  verify     each frequency without control and with it
  report     report.html: predicted and verified side by side, the share of the bound

examples:
  quiesce commission first --sim sim_hil/data/plants/squeeze_2012.toml --quick
  quiesce commission press --bus socketcan:can0 --max-current 2 --drive 0.1 --base-plant mine.toml
  quiesce commission press --bus socketcan:can0           goes on where it was left
  quiesce commission press --list                         what is done, and what came of it
  quiesce commission press --bus socketcan:can0 --from tune --no-quick

FOLDER has everything: its state is commission.json, written after each step. Leave at any time with
q, or Ctrl-C: the coil gets its safe current, and the step that was under way is done again. Before
anything drives the coil of real hardware it asks, and only 'yes' goes on; no law asks for more than
--max-current. On a bus OperatorCommand enables the controller; where it does not, it asks for the
enable that you have at hand, ends with EmergencyStop, and has you take the enable away after that.
--sim runs by itself. docs/howto/commission.md explains each step.
Exit codes: 1 a step failed, the line says what to look at; 2 an option, a file or a recording that
is wrong or missing; 130 left.
"""


def add_parser(commands: argparse._SubParsersAction) -> None:
    parser = commands.add_parser(
        "commission",
        description="Go from an unknown structure to a controller at work on it, step by step.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("folder", type=Path, metavar="FOLDER")
    parser.add_argument("--list", action="store_true", help="what is done, and what came of it")
    parser.add_argument("--from", dest="begin", choices=STEPS, metavar="STEP", help="go back to it")
    parser.add_argument("--until", choices=STEPS, metavar="STEP", help="the last step to do now")
    parser.add_argument("--fresh", action="store_true", help="give up what FOLDER has come to")
    add_structure(parser.add_argument_group("what is known"))
    parser.add_argument(
        "--sim", type=Path, metavar="PLANT.toml", help="a rig in the computer, in place of a bus"
    )
    parser.add_argument(
        "--set", action="append", metavar="NAME=VALUE",
        help="parameter that the simulated controller starts with; repeatable",
    )  # fmt: skip
    add_bus_options(parser)
    parser.set_defaults(run=with_packages(run))


def add_structure(group: argparse._ArgumentGroup) -> None:
    positive = real_number(1e-6, 1e6)
    group.add_argument(
        "--base-plant", type=Path, metavar="PLANT.toml",
        help="your sensor, driver, damper model and geometry (that of --sim; squeeze_2012)",
    )  # fmt: skip
    group.add_argument(
        "--damper", type=Path, metavar="FILE",
        help="a damper file; the structure is then excited without it (found in the recording)",
    )  # fmt: skip
    group.add_argument(
        "--modal-mass", type=positive, metavar="kg",
        help="of the first mode at the sensor; scales forces (1)",
    )  # fmt: skip
    group.add_argument(
        "--damper-elsewhere", action=argparse.BooleanOptionalAction,
        help="the damper does not act at the sensor",
    )  # fmt: skip
    group.add_argument(
        "--modes", type=whole_number(1, 16), metavar="N", help="in the swept band (found)"
    )
    group.add_argument(
        "--max-current", type=real_number(0.001, 20.0), metavar="A",
        help="that coil and driver may carry; required on a bus (that of --sim's driver)",
    )  # fmt: skip
    group.add_argument(
        "--drive", type=positive, metavar="V", help="of the shaker (that of --sim's plant)"
    )
    group.add_argument(
        "--band", type=real_number(0.1, 1000.0), nargs=2, metavar=("LOW", "HIGH"),
        help="of the first look (1 100 Hz)",
    )  # fmt: skip
    group.add_argument(
        "--first-mode", type=real_number(0.1, 100.0), metavar="Hz", help="saves the first look"
    )
    group.add_argument(
        "--as-mounted", action=argparse.BooleanOptionalAction,
        help="leave the accelerometer where it is: its scale is its data sheet's",
    )  # fmt: skip
    group.add_argument(
        "--setting", choices=("balanced", "displacement"),
        help="what the pulses are for (balanced)",
    )  # fmt: skip
    group.add_argument(
        "--quick", action=argparse.BooleanOptionalAction,
        help="a shorter sweep, fewer frequencies",
    )  # fmt: skip


def given_by(args: argparse.Namespace) -> dict[str, Any]:
    """Of Wants, what is named: the rest is as the folder was begun with."""
    if args.sim is not None and not args.sim.is_file():
        raise UsageError(f"--sim {args.sim}: there is no such file")
    said = {"plant": whole(args.sim), "start": None if args.set is None else tuple(args.set)}
    return {name: one for name, one in said.items() if one is not None} | structure_by(args)


def structure_by(args: argparse.Namespace) -> dict[str, Any]:
    """Of Wants, what is named of add_structure's."""
    for option in ("base_plant", "damper"):
        file = getattr(args, option)
        if file is not None and not file.is_file():
            raise UsageError(f"--{option.replace('_', '-')} {file}: there is no such file")
    if args.band is not None and args.band[0] >= args.band[1]:
        raise UsageError(f"--band {args.band[0]:g} {args.band[1]:g}: the first must be lower")
    said = {
        "base_plant": whole(args.base_plant),
        "damper": whole(args.damper),
        "modal_mass_kg": args.modal_mass,
        "is_damper_elsewhere": args.damper_elsewhere,
        "mode_count": args.modes,
        "max_current_A": args.max_current,
        "drive_V": args.drive,
        "band_Hz": None if args.band is None else tuple(args.band),
        "first_mode_Hz": args.first_mode,
        "is_as_mounted": args.as_mounted,
        "setting": args.setting,
        "is_quick": args.quick,
    }
    return {name: one for name, one in said.items() if one is not None}


def whole(file: Path | None) -> str | None:
    return None if file is None else str(file.resolve())


class Terminal:
    """Somebody at this terminal."""

    def do(self, text: str) -> None:
        self._ask(f"{text}.\n  Enter: done, q: leave > ")

    def allow(self, text: str) -> None:
        from quiesce.commission.hand import Left

        if self._ask(f"{text}.\n  yes: go on, anything else: leave > ") != "yes":
            raise Left("not allowed")

    def _ask(self, text: str) -> str:
        from quiesce.commission.hand import Left

        print(text, end="", file=sys.stderr, flush=True)
        answer = sys.stdin.readline()
        if not answer or answer.strip().lower() == "q":
            raise Left("left")
        return answer.strip().lower()


def run(args: argparse.Namespace) -> int:
    # Imported late: scipy and matplotlib are slow, and a refusal by the parser needs neither.
    from quiesce.commission.folder import Folder
    from quiesce.commission.hand import Left
    from quiesce.commission.run import Order, commission, listed

    if args.list:
        rows = [[name, text or "-"] for name, text in listed(Folder(args.folder))]
        print(format_table(["step", "what came of it"], rows, (0, 1)))
        return 0
    order = Order(args.folder, given_by(args), args.begin, args.until, args.fresh)
    try:
        commission(order, lambda text: say(f"quiesce: {text}"), partial(site_of, args), tell)
    except (Left, KeyboardInterrupt) as error:
        why = str(error) or "interrupted"
        print(f"quiesce: {why}; the same command goes on with the step", file=sys.stderr)
        return EXIT_INTERRUPTED
    print(f"written    {shown(args.folder)}")
    return 0


def site_of(args: argparse.Namespace, wants: "Wants", folder: "Folder") -> "Site":
    from quiesce.can.link import Link
    from quiesce.commission.by_hand import site_on_bus
    from quiesce.commission.simulated import own_site
    from quiesce.rig import Rig

    if wants.plant is not None:
        return own_site(wants, folder)
    return site_on_bus(Rig(Link(bus_of(args))), Terminal(), wants, folder)


def tell(text: str) -> None:
    print(text, flush=True)
