"""`quiesce sweep`: what to record, a recording of a simulated plant, the plant in a recording."""

import argparse
from pathlib import Path
from typing import Any

import numpy as np

from quiesce.base.atomic import output_files
from quiesce.base.command import finite_number, whole_number
from quiesce.base.errors import UsageError
from quiesce.base.paths import results_folder, results_text, shown
from quiesce.cli.terminal import show
from quiesce.plant_id.sweep import SweepPlan, Timeline, dwell_s, timeline, write_line
from quiesce.recording.write import require_writer

EPILOG = """examples:
  quiesce sweep --out excitation.csv --band 3 60 --drive 0.1 --max-current 2
  quiesce sweep --simulate sim_hil/data/plants/squeeze_2012.toml --out recording.csv
  quiesce sweep --identify recording.csv --out build/identified

The file has the columns time_s, drive_V and current_cmd_A: first a drive sweep at 0 A, then dwells
at fixed frequencies in which the current steps through several levels and then jumps between 0 and
the largest. Everything begins and ends at rest. Play it, record the accelerometer beside it as
accel_m_s2 at the same rate, and give the result to --identify, which writes a plant file, a report
with confidence intervals, and plots. Dwell below, near and above the first mode: --first-mode does
that. --simulate records a simulated plant instead, with its sensor's noise and rounding.
"""

# Where the response tells most about a damper: stick and slip below the mode, force and lag near
# it and above it. In parts of the first mode's frequency.
TELLING_PARTS = (0.45, 0.75, 1.05, 1.6)

GUIDE = """
What to do with it:
1. Start with a small --drive and --max-current; no part may clip the sensor or close the damper.
2. Play drive_V and current_cmd_A at {rate_Hz} Hz; record the acceleration at the same instants.
3. Write time_s, drive_V, current_cmd_A, accel_m_s2 (m/s2) into one CSV file, a row a sample.
4. quiesce sweep --identify FILE.csv --out DIR"""


def add_parser(commands: argparse._SubParsersAction) -> None:
    parser = commands.add_parser(
        "sweep",
        description="Find your own plant: the excitation to record, and what a recording says.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    work = parser.add_mutually_exclusive_group()
    work.add_argument(
        "--simulate", type=Path, metavar="PLANT.toml", help="record this simulated plant"
    )
    work.add_argument("--identify", type=Path, metavar="FILE", help="find the plant")
    parser.add_argument(
        "--out",
        type=Path,
        metavar="PATH",
        help="file to write: CSV, .mat or .uff; with --identify a folder "
        f"({results_text('sweep/...')})",
    )
    add_plan_options(parser.add_argument_group("what to record"))
    add_find_options(parser.add_argument_group("with --identify"))
    parser.set_defaults(run=run)


def add_plan_options(group: argparse._ArgumentGroup) -> None:
    plan = SweepPlan()

    def number(name: str, default: float, unit: str, text: str) -> None:
        group.add_argument(
            name,
            type=finite_number,
            default=default,
            metavar=unit,
            help=f"{text} (%(default)g {unit})",
        )

    group.add_argument("--rate", type=int, default=plan.rate_Hz, metavar="Hz", help="(%(default)d)")
    group.add_argument(
        "--band",
        type=finite_number,
        nargs=2,
        default=[plan.low_Hz, plan.high_Hz],
        metavar=("LOW", "HIGH"),
        help="frequencies of the sweep (3 120 Hz)",
    )
    group.add_argument("--linear", action="store_true", help="linear sweep (logarithmic)")
    number("--sweep-s", plan.sweep_s, "s", "its duration")
    number("--drive", plan.drive_V, "V", "amplitude of the drive")
    group.add_argument(
        "--dwell-drive",
        type=finite_number,
        metavar="V",
        help="amplitude in the dwells (that of --drive)",
    )
    group.add_argument(
        "--dwell-hz",
        type=finite_number,
        nargs="+",
        metavar="Hz",
        help="frequencies of the dwells (5 8 12 18)",
    )
    group.add_argument(
        "--first-mode",
        type=finite_number,
        metavar="Hz",
        help="dwell below, near and above this mode",
    )
    number("--max-current", plan.max_current_A, "A", "largest current")
    number("--hold-s", plan.hold_s, "s", "time at each level: long enough to settle")
    number("--rest-s", plan.rest_s, "s", "rest between the parts: long enough to decay")
    group.add_argument("--seed", type=int, default=1, help="of the simulated noise (%(default)d)")


def add_find_options(group: argparse._ArgumentGroup) -> None:
    group.add_argument(
        "--base-plant",
        type=Path,
        metavar="PLANT.toml",
        help="plant file with your sensor, driver, damper model and geometry (squeeze_2012)",
    )
    group.add_argument(
        "--modal-mass",
        type=finite_number,
        default=1.0,
        metavar="kg",
        help="of the first mode at the sensor; scales all forces (%(default)g)",
    )
    group.add_argument(
        "--damper-elsewhere",
        action="store_true",
        help="the damper does not act where the sensor is: fit the shapes there, too",
    )
    group.add_argument(
        "--modes", type=whole_number(1, 16), metavar="N", help="modes in the swept band (found)"
    )


def plan_of(args: argparse.Namespace) -> SweepPlan:
    """UsageError, naming the option, for what cannot be recorded."""
    if args.dwell_hz and args.first_mode:
        raise UsageError("--dwell-hz and --first-mode exclude each other")
    dwell_Hz = tuple(args.dwell_hz or SweepPlan.dwell_Hz)
    if args.first_mode is not None:
        dwell_Hz = tuple(round(part * args.first_mode, 3) for part in TELLING_PARTS)
    return SweepPlan(
        rate_Hz=args.rate,
        low_Hz=args.band[0],
        high_Hz=args.band[1],
        is_linear=args.linear,
        sweep_s=args.sweep_s,
        drive_V=args.drive,
        dwell_Hz=dwell_Hz,
        dwell_drive_V=args.drive if args.dwell_drive is None else args.dwell_drive,
        max_current_A=args.max_current,
        hold_s=args.hold_s,
        rest_s=args.rest_s,
    )


def plot_plan(file: Path, line: Timeline, accel_m_s2: np.ndarray | None) -> None:
    from quiesce.report.plot_style import COLORS, pyplot
    from quiesce.signal.replay_plot import band

    plt = pyplot()
    shown_columns: list[tuple[str, str, Any]] = [
        ("drive (V)", COLORS["main"], line.drive_V),
        ("current (A)", COLORS["current"], line.current_A),
    ]
    if accel_m_s2 is not None:
        shown_columns.append(("acceleration\n(m/s²)", COLORS["muted"], accel_m_s2))
    count = len(shown_columns)
    figure, axes = plt.subplots(count, 1, sharex=True, figsize=(10, 1.8 * count + 0.6))
    for one, (label, color, values) in zip(axes, shown_columns, strict=True):
        one.fill_between(*band(line.time_s, values), color=color, linewidth=0.8)
        one.set_ylabel(label)
    axes[-1].set_xlabel("time (s)")
    figure.savefig(file)
    plt.close(figure)


def recorded(args: argparse.Namespace, line: Timeline) -> np.ndarray:
    """What the simulated plant's sensor reads."""
    from quiesce.plant.library import Plant
    from quiesce.plant_id.simulate import record

    return record(Plant(args.simulate), line, args.seed)


def write_plan(args: argparse.Namespace) -> int:
    plan = plan_of(args)
    line = timeline(plan)
    accel_m_s2 = recorded(args, line) if args.simulate else None
    name = "recording.csv" if args.simulate else "excitation.csv"
    out = args.out or results_folder() / "sweep" / name
    if out.is_dir():
        raise UsageError(f"{shown(out)} is a folder; name a file for --out")
    with output_files(out.parent) as staging:
        write_line(staging / out.name, line, accel_m_s2)
        plot_plan(staging / f"{out.stem}.png", line, accel_m_s2)
    dwells = ", ".join(f"{freq_Hz:g}" for freq_Hz in plan.dwell_Hz)
    kind = "linear" if plan.is_linear else "logarithmic"
    print(
        f"sweep      {plan.low_Hz:g} to {plan.high_Hz:g} Hz, {kind}, {plan.sweep_s:g} s, "
        f"{plan.drive_V:g} V, 0 A\n"
        f"dwells     {dwells} Hz, {dwell_s(plan):.1f} s each, {plan.dwell_drive_V:g} V, "
        f"0 to {plan.max_current_A:g} A\n"
        f"in all     {line.time_s[-1]:.1f} s at {plan.rate_Hz} Hz, {len(line.time_s)} rows\n"
        f"written    {shown(out)}, {shown(out.with_suffix('.png'))}"
    )
    if not args.simulate:
        print(GUIDE.format(rate_Hz=plan.rate_Hz))
    return 0


def run_find(args: argparse.Namespace) -> int:
    # Imported late: scipy is slow, and no other command needs it.
    from quiesce.plant_id.find import find_plant

    if args.modal_mass <= 0.0:
        raise UsageError("--modal-mass: expected more than 0 kg")
    out = args.out or results_folder() / "sweep" / args.identify.stem
    found = find_plant(
        args.identify,
        out,
        args.base_plant,
        args.modal_mass,
        not args.damper_elsewhere,
        args.modes,
    )
    show(found.text)
    print(f"\nwritten    {', '.join(shown(file) for file in sorted(out.iterdir()))}")
    return 0


def run(args: argparse.Namespace) -> int:
    if args.identify:
        return run_find(args)
    if args.out:
        require_writer(args.out.suffix)
    return write_plan(args)
