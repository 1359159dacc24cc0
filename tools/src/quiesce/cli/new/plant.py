"""`quiesce new plant NAME`: plant, board and scenario files of a structure of the user's."""

import argparse
import json
import shlex
import sys
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from quiesce.base.command import real_number, whole_number
from quiesce.base.paths import shown, typed
from quiesce.base.table import format_table
from quiesce.cli.terminal import show

if TYPE_CHECKING:
    from quiesce.plant.new.made import Made
    from quiesce.plant.new.order import Order

EPILOG = """what shakes: --drive KIND:RANGE,LEVEL, a sine at any frequency of a range
  force:5..40Hz,20N         a force at --drive-at; 20 N is the amplitude
  base:2..8Hz,0.5m/s2       what the structure stands on: acceleration, in m/s2 or g
  force:10Hz,20N            one frequency

the structure, in one of two forms
  --mass 250,40 --stiffness 16000,160000
      bodies on springs, from the top down to the ground: 250 kg on a spring of 16 kN/m on
      40 kg on a spring of 160 kN/m on the ground. One body: --mass 120 --freq 2.9 does, too
  --cantilever --mass 4 --freq 11.5
      a uniform beam of 4 kg, clamped at the base: bending modes. Places are parts of its length:
      --damper-at 0.6; without one, its free end

examples:
  quiesce new plant press --mass 120 --freq 2.9 --damper rd1005_kwok_tanh_smooth \\
      --drive force:1.5..6Hz,100N --accel pcb_333B32
  quiesce new plant corner --mass 315,37.5 --stiffness 29500,210000 --bodies body,wheel \\
      --damper strut.toml --lever 0.6 --drive base:1..15Hz,1m/s2 -o corner
  quiesce new plant boom --cantilever --mass 4 --freq 11.5 --damper my_damper.toml \\
      --drive force:5..20Hz,0.5N --drive-at 0.4

Written to --out (NAME): plant.toml, board.toml, steps.toml (steady vibration at some frequencies),
random.toml, damper.toml and sensor.toml (copies). Every number has its unit and where it is from
beside it. They are checked, and run once without current and once with the largest; what does not
run is refused, and nothing is written. docs/howto/own-plant.md goes on from there.
"""


def numbers(low: float, high: float) -> Callable[[str], list[float]]:
    """A type for argparse: numbers in low .. high with commas between them."""
    one = real_number(low, high)
    return lambda text: [one(word) for word in text.split(",")]


def names(text: str) -> list[str]:
    return text.split(",")


def add_parser(actions: argparse._SubParsersAction) -> None:
    parser = actions.add_parser(
        "plant",
        help="plant, board and scenario files of your own structure",
        description="Write plant, board and scenario files of your own structure.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("name", metavar="NAME", help="a letter, then letters, digits or _")
    add_structure(parser.add_argument_group("structure"))
    add_damper(parser.add_argument_group("damper"))
    add_rest(parser.add_argument_group("what shakes, what measures"))
    parser.add_argument("-o", "--out", type=Path, metavar="FOLDER", help="(NAME)")
    parser.add_argument("--force", action="store_true", help="overwrite files that are there")
    parser.add_argument("--json", action="store_true", help="print one JSON object")
    parser.set_defaults(run=run)


def add_structure(group: argparse._ArgumentGroup) -> None:
    group.add_argument(
        "--mass", type=numbers(1e-6, 1e9), required=True, metavar="KG[,KG..]",
        help="from the top body down; with --cantilever the beam's",
    )  # fmt: skip
    group.add_argument(
        "--stiffness", type=numbers(1e-6, 1e12), metavar="N_M[,..]",
        help="N/m of the spring below each body; with --cantilever static, at the free end",
    )  # fmt: skip
    group.add_argument(
        "--freq", type=real_number(0.01, 1000.0), metavar="HZ",
        help="natural frequency without the damper, in place of --stiffness; a cantilever's first",
    )  # fmt: skip
    group.add_argument(
        "--damping-ratio", type=real_number(0.0, 0.9), default=0.01, metavar="Z",
        help="of each mode, without the damper (%(default)s)",
    )  # fmt: skip
    group.add_argument("--bodies", type=names, metavar="NAME[,..]", help="(mass; mass1,mass2; end)")
    group.add_argument("--cantilever", action="store_true", help="a beam in place of bodies")
    group.add_argument(
        "--end-mass",
        type=real_number(0.0, 1e9),
        metavar="KG",
        help="at a cantilever's free end (0)",
    )


def add_damper(group: argparse._ArgumentGroup) -> None:
    group.add_argument(
        "--damper", required=True, metavar="FILE|NAME",
        help="an identified one (quiesce identify), or one of sim_hil/data/dampers",
    )  # fmt: skip
    group.add_argument(
        "--damper-at", metavar="BODY[:OTHER]",
        help="its ends; OTHER: a body or ground (from the top body to what is below it)",
    )  # fmt: skip
    group.add_argument(
        "--lever",
        type=real_number(0.01, 100.0),
        metavar="X",
        help="its stroke for 1 m between them (1)",
    )
    group.add_argument(
        "--max-current", type=real_number(0.001, 1000.0), metavar="A",
        help="of its driver (the largest at which it was identified)",
    )  # fmt: skip


def add_rest(group: argparse._ArgumentGroup) -> None:
    group.add_argument("--drive", required=True, metavar="DRIVE", help="see below")
    group.add_argument("--drive-at", metavar="BODY", help="of a force (the top body)")
    group.add_argument(
        "--accel", metavar="FILE|NAME",
        help="sensor file, or one of sim_hil/data/sensors (ideal, but for 0.5 mg of noise)",
    )  # fmt: skip
    group.add_argument(
        "--accel-at", type=names, metavar="BODY[,..]",
        help="of accelerometers; the first one's frequency and RMS are what laws see (the top)",
    )  # fmt: skip
    group.add_argument(
        "--range", type=real_number(0.01, 50.0), metavar="G",
        help="of the accelerometer, +- (at least twice the peak without current)",
    )  # fmt: skip
    group.add_argument(
        "--bits",
        type=whole_number(8, 24),
        default=20,
        metavar="N",
        help="of its converter (%(default)s)",
    )


def make_order(args: argparse.Namespace) -> "Order":
    from quiesce.plant.new.order import Order

    return Order(
        name=args.name,
        command=shlex.join(["quiesce", "new", "plant", *asked_words(args)]),
        masses_kg=args.mass,
        stiffness_N_m=args.stiffness,
        freq_Hz=args.freq,
        damping_ratio=args.damping_ratio,
        bodies=args.bodies,
        is_cantilever=args.cantilever,
        end_kg=args.end_mass,
        damper=args.damper,
        damper_at=args.damper_at,
        lever=args.lever,
        max_current=args.max_current,
        drive=args.drive,
        drive_at=args.drive_at,
        accel=args.accel,
        accel_at=args.accel_at,
        range_g=args.range,
        bits=args.bits,
        folder=args.out or Path(args.name),
        is_forced=args.force,
    )


def asked_words(args: argparse.Namespace) -> list[str]:
    """What decides the files, as it can be typed again."""
    words = [args.name] + (["--cantilever"] if args.cantilever else [])
    for name in ("mass", "stiffness", "freq", "damping_ratio", "bodies", "end_mass", "damper",
                 "damper_at", "lever", "max_current", "drive", "drive_at", "accel", "accel_at",
                 "range", "bits"):  # fmt: skip
        value = getattr(args, name)
        if value is not None and (name, value) not in (("damping_ratio", 0.01), ("bits", 20)):
            words += [f"--{name.replace('_', '-')}", word_of(value)]
    return words


def word_of(value: Any) -> str:
    if isinstance(value, list):
        return ",".join(word_of(one) for one in value)
    return f"{value:g}" if isinstance(value, float) else str(value)


def run(args: argparse.Namespace) -> int:
    # Imported late: numpy is slow, and a refusal by the parser needs none of it.
    from quiesce.plant.new.made import make

    order = make_order(args)
    made = make(order)
    for note in made.notes:
        print(f"quiesce: note: {note}", file=sys.stderr)
    data = data_of(made, order.folder)
    show(json.dumps(data, indent=1) if args.json else text_of(made, order.folder))
    return 0


def data_of(made: "Made", folder: Path) -> dict[str, Any]:
    plan = made.plan
    return {
        "name": plan.name,
        "folder": str(folder),
        "files": made.names,
        "natural_frequencies_Hz": plan.structure.freqs_Hz,
        "max_current_A": plan.damper.max_current,
        "range_g": plan.range_g,
        "steps": [
            {"freq_Hz": off.freq_Hz,
             "disp_um_at_0_A": off.disp_um, "accel_mm_s2_at_0_A": off.accel_mm_s2,
             "disp_um_at_full": on.disp_um, "accel_mm_s2_at_full": on.accel_mm_s2}
            for off, on in zip(made.at_rest.steps, made.at_full.steps, strict=True)
        ],
        "notes": made.notes,
    }  # fmt: skip


def text_of(made: "Made", folder: Path) -> str:
    plan = made.plan
    full = f"{plan.damper.max_current:g} {'V' if plan.damper.is_in_volts else 'A'}"
    own = ", ".join(f"{freq_Hz:.4g}" for freq_Hz in plan.structure.freqs_Hz)
    rows = [
        (off.freq_Hz, off.disp_um, off.accel_mm_s2, on.disp_um, on.accel_mm_s2)
        for off, on in zip(made.at_rest.steps, made.at_full.steps, strict=True)
    ]
    head = ["Hz||g", "0 A: um||.1f", "mm/s2||.1f", f"{full}: um||.1f", "mm/s2||.1f"]
    return "\n".join(
        [
            f"structure  {plan.structure.what}: {own} Hz without the damper",
            f"damper     {plan.damper.name}, {' to '.join(plan.structure.damper_ends)}: "
            f"0 .. {full}, {plan.damper.current_note}",
            f"drive      {plan.drive.kind}, {plan.drive.level:g} {plan.drive.unit}, "
            f"{plan.drive.low_Hz:g} .. {plan.drive.high_Hz:g} Hz",
            f"sensor     +-{plan.range_g:g} g, {plan.bits} bits; at most "
            f"{made.at_rest.peak_m_s2 / 9.80665:.3g} g without current",
            "",
            format_table(head, rows, left=()),
            "",
            f"written    {shown(folder)}: {', '.join(made.names)}",
            *next_lines(made, folder),
        ]
    )


def next_lines(made: "Made", folder: Path) -> list[str]:
    """What to type with these files."""
    drive = made.plan.drive
    plant, steps, rules, pulses = (
        shown(folder / name) for name in ("plant.toml", "steps.toml", "rules", "pulses")
    )
    band = "" if drive.is_single else f" --from-Hz {drive.low_Hz:g} --to-Hz {drive.high_Hz:g}"
    return [
        f"run it     {typed('quiesce hil')} --scenario {steps} --target host",
        f"rules      {typed('quiesce rules optimize')} --scenario {steps} --out {rules}",
        f"pulses     {typed('quiesce tune')} {plant}{band} --out {pulses}",
    ]
