"""Options that name a structure and what shakes it."""

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from quiesce.base.command import real_number
from quiesce.base.errors import UsageError
from quiesce.base.nearest import listed
from quiesce.base.paths import measurements, root, shown
from quiesce.compare.names import ACCEL, TIME

if TYPE_CHECKING:
    from quiesce.compare.records import Record
    from quiesce.compare.run import Shaking


def add_rig(parser: argparse.ArgumentParser, several: bool = False) -> None:
    rig = parser.add_argument_group("structure")
    text = "a plant and a board that ship under one name"
    if several:
        rig.add_argument("--rig", metavar="NAME", action="append", help=f"{text}; may be repeated")
    else:
        rig.add_argument("--rig", metavar="NAME", help=text)
    rig.add_argument("--plant", type=Path, metavar="FILE", help="plant, TOML")
    rig.add_argument("--board", type=Path, metavar="FILE", help="its board, TOML")


def add_motions(parser: argparse.ArgumentParser) -> None:
    shake = parser.add_argument_group("ground motions")
    shake.add_argument(
        "--record", type=Path, action="append", default=[], metavar="FILE",
        help="CSV or AT2; may be repeated (all that lie beside the project)",
    )  # fmt: skip
    shake.add_argument(
        "--road", action="append", default=[], metavar="ROAD",
        help="CLASS:KM_H of ISO 8608, as in C:72, or bump:HEIGHT_M:LENGTH_M:KM_H; may be repeated",
    )  # fmt: skip
    shake.add_argument("--time-column", default=TIME, metavar="NAME", help="of CSV (%(default)s)")
    shake.add_argument(
        "--accel-column", default=ACCEL, metavar="NAME",
        help="of CSV; its end is its unit, _m_s2, _mm_s2 or _g (%(default)s)",
    )  # fmt: skip
    shake.add_argument(
        "--time-scale", type=real_number(0.01, 100.0), default=1.0, metavar="X",
        help="play so many times as fast (%(default)s)",
    )  # fmt: skip
    shake.add_argument(
        "--gain", type=real_number(1e-6, 1e6), default=1.0, metavar="X", help="(%(default)s)"
    )
    shake.add_argument(
        "--scale-to", type=real_number(1e-6, 1e4), metavar="M_S2", help="peak of each record"
    )


def rig_files(args: argparse.Namespace) -> tuple[Path, Path]:
    """Plant and board. UsageError where they are not named, or twice."""
    _require_one(args)
    return _shipped(args.rig) if args.rig else (args.plant, args.board)


def several_rig_files(args: argparse.Namespace) -> list[tuple[Path, Path]]:
    """Likewise, of every structure that is named."""
    _require_one(args)
    rigs = args.rig or []
    for name in rigs:
        if rigs.count(name) > 1:
            raise UsageError(f"--rig {name} is named twice")
    return [_shipped(name) for name in rigs] or [(args.plant, args.board)]


def _require_one(args: argparse.Namespace) -> None:
    if not args.rig and (args.plant is None or args.board is None):
        raise UsageError("name the structure: --rig NAME, or --plant FILE and --board FILE")
    if args.rig and (args.plant or args.board):
        raise UsageError("--rig stands for --plant and --board; give it or them")


def _shipped(name: str) -> tuple[Path, Path]:
    data = root() / "sim_hil/data"
    names = sorted(
        {one.stem for one in (data / "plants").glob("*.toml")}
        & {one.stem for one in (data / "boards").glob("*.toml")}
    )
    if name not in names:
        raise UsageError(f"--rig {name}: {listed(name, names)}")
    return data / f"plants/{name}.toml", data / f"boards/{name}.toml"


def records_of(args: argparse.Namespace) -> "list[Record]":
    # Imported late: numpy is slow, and options need none of it.
    from quiesce.compare.records import read_record
    from quiesce.compare.roads import read_road

    folder = measurements("earthquake")
    files = args.record or ([] if args.road else sorted(folder.glob("*.csv")))
    if not files and not args.road:
        raise UsageError(f"no records beside the project ({shown(folder)}); name some: --record")
    found = [read_record(file, args.time_column, args.accel_column) for file in files]
    found += [read_road(text) for text in args.road]
    names = [record.name for record in found]
    for name in names:
        if names.count(name) > 1:
            raise UsageError(f"--record: two are called {name}")
    return found


def shaking_of(args: argparse.Namespace) -> "Shaking":
    from quiesce.compare.run import Shaking

    return Shaking(args.time_scale, args.gain, args.scale_to)


def words_of_motions(args: argparse.Namespace) -> list[str]:
    """Structure and motions as they can be typed again."""
    words = ["--rig", args.rig] if args.rig else []
    words += [] if args.rig else ["--plant", shown(args.plant), "--board", shown(args.board)]
    for name in ("record", "road"):
        words += [word for value in getattr(args, name) for word in (f"--{name}", _told(value))]
    defaults = {"time_column": TIME, "accel_column": ACCEL, "time_scale": 1.0, "gain": 1.0}
    for name in ("time_column", "accel_column", "time_scale", "gain", "scale_to"):
        if (value := getattr(args, name)) != defaults.get(name):
            words += [f"--{name.replace('_', '-')}", _told(value)]
    return words


def _told(value: Path | str | float) -> str:
    if isinstance(value, float):
        return f"{value:g}"
    return shown(value) if isinstance(value, Path) else value
