"""`quiesce identify inverse FILE`: can the current be found from the force, map and inverses."""

import argparse
import json
from dataclasses import replace
from pathlib import Path
from typing import Any

from quiesce.base.command import real_number
from quiesce.base.errors import UsageError
from quiesce.base.paths import shown
from quiesce.cli.identify import inverse_methods
from quiesce.cli.identify.help import fill
from quiesce.cli.terminal import show
from quiesce.table.file import SUFFIX

NAME = "inverse"
HELP = "the current for a wanted force: check and map, or inverses by several methods"
EPILOG = """Without --method, the check of a damper file. A control law wants a force; the inverse
gives the current. That needs a force that rises with the current: the check says up to which
current it does, at several velocities in mid-stroke of a sine that has settled. --out writes
inverse.csv (velocity, force, current, feasible), forces.csv, inverse.svg and, unless the last line
of the check says why not, map.table: the map that tracker inverse of a controller takes
(quiesce_bench run --force-map). Currents saturate where the force is not feasible. Of a spring that
the current stiffens, such as an elastomer, --over stroke makes the map.

A map of one damper stands for every damper of a controller. With table files (map.table), one
map is made of all of them, the first for the controller's first damper; --out takes it. Likewise of
banks (bank.table).

With --method, inverses are made and follow wanted forces (sines, a sweep, band noise) on the
damper, beside the best constant current and the ideal inverse. Some methods need a damper file,
others learn from recordings, or from tests made with the damper file. --out writes a file for each
(map.table, inverse_NAME.toml; --read reads them back), map_NAME.table for those that the tracker
can have as a map, and inverse.html.
"""
EXAMPLES = """
examples:
  quiesce identify inverse damper.toml --max-current-A 2 --out build/inverse
  quiesce identify inverse mount.toml --over stroke --max-current-A 1.78 --out build/mount
  quiesce identify inverse build/inverse/map.table build/mount/map.table --out build/both
  quiesce identify inverse damper.toml --method all --out build/inverse
  quiesce identify inverse rig.csv --method ffn,rnn --on damper.toml --out build/inverse
  quiesce identify inverse damper.toml --read build/inverse/inverse_rnn.toml
"""


def add_options(parser: argparse.ArgumentParser) -> None:
    fill(parser, EPILOG + inverse_methods.help_lines() + EXAMPLES)
    parser.add_argument(
        "files",
        type=Path,
        nargs="+",
        metavar="FILE",
        help="damper file, recordings (CSV), or maps to be one (.table)",
    )
    parser.add_argument(
        "--max-current-A", type=real_number(1e-6, 1e3, "a current in A"), metavar="A",
        help="largest current (max_current_A of the file's [valid])",
    )  # fmt: skip
    parser.add_argument(
        "--max-speed-m-s", type=real_number(1e-6, 1e3, "a speed in m/s"), metavar="m/s",
        help="largest speed (that of the file)",
    )  # fmt: skip
    parser.add_argument(
        "--amplitude-mm", type=real_number(1e-3, 1e4, "a length in mm"), metavar="mm",
        help="of the sines (half the file's stroke)",
    )  # fmt: skip
    parser.add_argument(
        "--over", choices=("velocity", "stroke"), default="velocity",
        help="what the check's forces go over and have the sign of (%(default)s)",
    )  # fmt: skip
    parser.add_argument("--out", type=Path, metavar="FOLDER", help="write map and plot there")
    parser.add_argument("--json", action="store_true", help="print one JSON object")
    inverse_methods.add_options(parser)


def run(args: argparse.Namespace) -> int:
    from quiesce.damper.inverse import check_amperes
    from quiesce.damper.simulate import simulator_of_file

    if any(file.suffix == SUFFIX for file in args.files):
        return join(args)
    is_recording = inverse_methods.is_recording(args.files)
    inverse_methods.check_options(args, is_recording)
    if is_recording:
        return inverse_methods.run(args, None, None, 0.0)
    damper, simulate = simulator_of_file(args.files[0])
    check_amperes(damper)
    if args.max_speed_m_s:
        damper = replace(damper, speed_m_s=args.max_speed_m_s)
    if args.amplitude_mm:
        damper = replace(damper, stroke_m=2e-3 * args.amplitude_mm)
    most_A = args.max_current_A or stated_current(damper)
    if args.method or args.read:
        if args.over != "velocity":
            raise UsageError("--over stroke is for the check; leave --method and --read out")
        return inverse_methods.run(args, damper, simulate, most_A)
    return check(args, damper, simulate, most_A)


def join(args: argparse.Namespace) -> int:
    from quiesce.damper.force_map import joined, maps_of_words
    from quiesce.damper.inverses import banked
    from quiesce.damper.inverses.mapped import read_map
    from quiesce.damper.report.inverse_text import write_joined

    if args.method or args.read or args.json or args.out is None:
        raise UsageError("maps (.table) are made one with --out FOLDER and no other option")
    if all(banked.is_bank(file) for file in args.files):
        words = banked.joined(args.files)
        write_joined(args.out, words, "bank.table")
        print(f"written: {shown(args.out)}/bank.table, {4 * len(words)} bytes")
        return 0
    try:
        words = joined([read_map(file) for file in args.files])
    except ValueError as error:
        raise UsageError(f"{', '.join(shown(file) for file in args.files)}: {error}") from None
    write_joined(args.out, words)
    for number, one in enumerate(maps_of_words(words), 1):
        print(f"damper {number}: over {one.axis.name}, 0 .. {one.currents_A[-1]:g} A")
    print(f"written: {shown(args.out)}/map.table, {4 * len(words)} bytes")
    return 0


def check(args: argparse.Namespace, damper: Any, simulate: Any, most_A: float) -> int:
    from quiesce.damper.inverse import AXES, monotone_range
    from quiesce.damper.report.inverse_text import numbers_of, text_of, write_map

    others = None if damper.is_kernel else simulate
    found = monotone_range(damper, most_A, simulate=others, axis=AXES[args.over])
    if args.out:
        write_map(args.out, damper, found)
    show(json.dumps(numbers_of(damper, found), indent=1) if args.json else text_of(damper, found))
    if args.out and not args.json:
        also = ", map.table" if (args.out / "map.table").exists() else ""
        print(f"\nwritten: {shown(args.out)}/inverse.csv, forces.csv, inverse.svg{also}")
    return 0


def stated_current(damper: Any) -> float:
    from quiesce.damper.command_range import largest_command

    if (most_A := largest_command(damper)) is None:
        raise UsageError(
            f"{damper.name}: the file states no largest current; --max-current-A A does"
        )
    return most_A
