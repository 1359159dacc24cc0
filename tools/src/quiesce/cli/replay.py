"""`quiesce replay FILE`: recorded motion through the firmware's chain."""

import argparse
import json
from pathlib import Path
from typing import Any

import numpy as np

from quiesce.base.atomic import output_files
from quiesce.base.command import finite_number, whole_number
from quiesce.base.errors import UsageError
from quiesce.base.paths import results_folder, results_text, shown
from quiesce.cli.file_format import add_format, require_format
from quiesce.engine.bench import Bench
from quiesce.engine.board import load_board
from quiesce.signal.recording import M_S2_PER_UNIT, Recording, read_recording
from quiesce.signal.reference_peak import Agreement, WINDOW_s, compare, reference_freq_Hz
from quiesce.signal.replay import (
    Replayed,
    Source,
    board_columns,
    one_column,
    replay,
    summarize,
    write_telemetry,
)
from quiesce.signal.replay_plot import plot_replay
from quiesce.signal.resample import METHOD, is_same_rate

EPILOG = """examples:
  quiesce replay sim_hil/data/recordings/step_10_20Hz.csv --column accel_m_s2 --unit m_s2
  quiesce replay sweep.csv --column mems_g --unit g --reference-column piezo_g --from-s 23
  quiesce replay other.csv --column acc --unit g --time-column time --set rms_window_ms=1000
  quiesce replay rig.csv --board sim_hil/data/boards/two_storeys.toml \\
      --sensor floor_accel=acc_1:g --sensor roof_accel=acc_2:g --sensor upper_stroke=lvdt:mm

The file has one header line, a column of time in seconds and columns of acceleration. It is
resampled to the control rate (tick_rate_Hz), turned into counts of the sensor that the parameters
describe, and run through the controller with its output enabled. Written: replay.csv (telemetry
under its C names; --format for
another) and replay.png. With a reference column, the firmware's frequency at each of its
updates (every 4 ms) is compared with the reference's own peak (2 s Hann window); the latencies of
both are taken out.

With --board, columns go to sensors of that board by name, in a unit of what each measures:
acceleration m_s2, mm_s2, g; velocity m_s, mm_s; displacement and stroke m, mm, um; force N;
temperature degC; voltage V. A sensor with a period has a sample in the first tick of each. One that
is not named delivers none; the tracked one must be named. replay.csv then has the picture, too, as
body_quantity_unit and damper_quantity_unit.
"""


def add_parser(commands: argparse._SubParsersAction) -> None:
    parser = commands.add_parser(
        "replay",
        description="Run the firmware's chain over a recorded acceleration, or over columns for\n"
        "the sensors of a board: frequency, RMS and current against time, with a plot.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument(
        "file", metavar="FILE", type=Path, help="recording: CSV, MAT, UFF, MDF, LVM, HDF5, Parquet"
    )
    parser.add_argument("--column", help="column of the acceleration")
    parser.add_argument("--unit", choices=list(M_S2_PER_UNIT), help="its unit")
    parser.add_argument("--time-column", default="t_s", help="column of time in s (%(default)s)")
    parser.add_argument(
        "--set", action="append", default=[], metavar="NAME=VALUE", help="parameter, repeatable"
    )
    parser.add_argument("--target", choices=["host", "mps2"], default="host", help="(%(default)s)")
    parser.add_argument(
        "--every",
        type=whole_number(1, 1_000_000_000),
        default=10,
        metavar="N",
        help="ticks from one row of replay.csv to the next (%(default)s)",
    )
    parser.add_argument(
        "--out",
        type=Path,
        metavar="DIR",
        help=f"folder to write to ({results_text('replay/FILE')})",
    )
    add_format(parser, "replay.csv")
    parser.add_argument("--json", action="store_true", help="print the figures as JSON")
    add_board_options(parser.add_argument_group("columns for the sensors of a board"))
    add_reference_options(parser.add_argument_group("comparison with a reference sensor"))
    parser.set_defaults(run=run)


def add_board_options(group: argparse._ArgumentGroup) -> None:
    group.add_argument("--board", type=Path, metavar="BOARD.toml", help="what is wired to what")
    group.add_argument(
        "--sensor", action="append", default=[], metavar="NAME=COLUMN:UNIT", help="repeatable"
    )


def add_reference_options(group: argparse._ArgumentGroup) -> None:
    group.add_argument("--reference-column", metavar="NAME", help="a second acceleration")
    group.add_argument(
        "--from-s", type=finite_number, metavar="T", help="count updates from this time on (start)"
    )
    group.add_argument("--to-s", type=finite_number, metavar="T", help="and up to this time (end)")
    group.add_argument(
        "--tolerance-hz", type=finite_number, default=0.12, metavar="F", help="(%(default)s)"
    )
    group.add_argument(
        "--reference-delay-s",
        type=finite_number,
        default=0.0,
        metavar="T",
        help="the reference channel shows an event T later than --column (%(default)s)",
    )


def reference_curve(
    args: argparse.Namespace, recording: Recording
) -> tuple[np.ndarray, np.ndarray] | None:
    """Instants, on the clock of --column, and the reference's frequency there."""
    if args.reference_column is None:
        return None
    middle_s, freq_Hz = reference_freq_Hz(
        recording.accel_m_s2(args.reference_column, args.unit), recording.rate_Hz
    )
    if middle_s.size == 0:
        raise UsageError(
            f"{shown(args.file)}: {recording.duration_s:.3g} s long; a reference needs "
            f"{WINDOW_s:g} s"
        )
    return recording.start_s + middle_s - args.reference_delay_s, freq_Hz


def judge(
    args: argparse.Namespace, replayed: Replayed, reference: tuple[np.ndarray, np.ndarray]
) -> Agreement:
    step = replayed.updates
    time_s, latency_s = replayed.time_s[step], replayed.latency_s[step]
    from_s = float(replayed.time_s[0]) if args.from_s is None else args.from_s
    to_s = float(replayed.time_s[-1]) if args.to_s is None else args.to_s
    counted = (time_s >= from_s) & (time_s <= to_s)
    agreement = compare(
        (time_s - latency_s)[counted],
        (replayed.trace["freq_uHz"][step] * 1e-6)[counted],
        (replayed.trace["freq_is_valid"][step] > 0)[counted],
        *reference,
        tolerance_Hz=args.tolerance_hz,
        from_s=from_s,
        to_s=to_s,
    )
    if agreement.updates == 0:
        raise UsageError(
            f"--from-s {from_s:g} --to-s {to_s:g}: no update to compare there; the recording "
            f"spans {replayed.time_s[0]:g} .. {replayed.time_s[-1]:g} s"
        )
    return agreement


def agreement_figures(agreement: Agreement) -> dict[str, Any]:
    return {
        "from_s": agreement.from_s,
        "to_s": agreement.to_s,
        "tolerance_Hz": agreement.tolerance_Hz,
        "updates": agreement.updates,
        "valid_updates": agreement.valid,
        "valid_pct": round(agreement.valid_pct, 3),
        "within_pct": round(agreement.within_pct, 3),
        "worst_error_Hz": round(agreement.worst_Hz, 4),
    }


def source_text(args: argparse.Namespace) -> str:
    if args.board is None:
        return f"{args.column} in {args.unit}"
    return f"{', '.join(args.sensor)} on board {shown(args.board)}"


def known(value: float | None, unit: str) -> str:
    return "not known" if value is None else f"{value:.4g} {unit}"


def body_text(name: str, body: dict[str, float | None]) -> str:
    return (
        f"{name}: RMS {known(body['accel_rms_m_s2'], 'm/s2')}, {known(body['disp_rms_mm'], 'mm')}; "
        f"peak {known(body['accel_peak_m_s2'], 'm/s2')}, {known(body['disp_peak_mm'], 'mm')}"
    )


def damper_text(name: str, damper: dict[str, float | None]) -> str:
    return (
        f"{name}: command {damper['mean_current_A']:.3f} A on average, at most "
        f"{damper['max_current_A']:.3f} A; stroke RMS {known(damper['stroke_rms_mm'], 'mm')}, "
        f"peak {known(damper['stroke_peak_mm'], 'mm')}"
    )


def print_rig(figures: dict[str, Any]) -> None:
    """Nothing without a board."""
    lines = [("body", body_text(*one)) for one in figures.get("bodies", {}).items()]
    lines += [("damper", damper_text(*one)) for one in figures.get("dampers", {}).items()]
    for kind, text in lines:
        print(f"{kind:10} {text}")


def print_summary(args: argparse.Namespace, figures: dict[str, Any]) -> None:
    print(
        f"recording  {shown(args.file)}, {source_text(args)}: {figures['rows']} rows at "
        f"{figures['rate_Hz']:.6g} Hz, {figures['duration_s']:.1f} s"
    )
    if is_same_rate(figures["rows"], figures["rate_Hz"], figures["tick_rate_Hz"]):
        print("resampled  no: recorded at the control rate")
    else:
        print(f"resampled  to {figures['tick_rate_Hz']} Hz: {METHOD}")
    if figures["median_freq_Hz"] is None:
        print("frequency  never valid: no steady peak that stands out")
    else:
        print(
            f"frequency  valid {figures['valid_pct']:.1f} % of the time, first at "
            f"{figures['first_valid_s']:.2f} s; median {figures['median_freq_Hz']:.3f} Hz"
        )
        print(
            f"latency    the frequency describes the signal {figures['latency_s']:.3f} s earlier "
            "(median; half its window)"
        )
    print(
        f"RMS        at most {figures['max_rms_m_s2']:.4g} m/s2; mean current command "
        f"{figures['mean_current_A']:.3f} A"
    )
    print_rig(figures)
    faults = ", ".join(str(fault) for fault in figures["faults_seen"])
    print(f"faults     {faults or 'none'}")
    if figures["reference"]:
        ref = figures["reference"]
        print(
            f"reference  {args.reference_column}, {ref['from_s']:g} .. {ref['to_s']:g} s: "
            f"{ref['within_pct']:.2f} % of {ref['valid_updates']} valid updates within "
            f"{ref['tolerance_Hz']:g} Hz, worst {ref['worst_error_Hz']:.3f} Hz;\n"
            f"           valid were {ref['valid_pct']:.2f} % of {ref['updates']} updates"
        )
    print(f"written    {', '.join(figures['outputs'])}")


def source_of(args: argparse.Namespace, bench: Bench) -> Source:
    """UsageError where the options do not go together, or do not fit the board."""
    if args.board is None:
        if args.sensor:
            raise UsageError("--sensor goes with --board")
        if args.column is None or args.unit is None:
            raise UsageError("--column and --unit are needed, or --board and --sensor")
        return one_column(args.column, args.unit)
    for option in ("column", "unit", "reference_column"):
        if getattr(args, option) is not None:
            name = option.replace("_", "-")
            raise UsageError(f"--{name} goes without --board, which takes --sensor")
    return board_columns(load_board(bench, args.board), args.sensor)


def title_of(args: argparse.Namespace) -> str:
    return f"{args.file.name}: {args.column or args.board.name}"


def what_was_played(args: argparse.Namespace) -> dict[str, Any]:
    if args.board is None:
        return {"column": args.column, "unit": args.unit}
    return {"board": str(args.board), "sensors": args.sensor}


def run(args: argparse.Namespace) -> int:
    require_format(args)
    bench = Bench()
    source = source_of(args, bench)
    columns = source.columns + ([args.reference_column] if args.reference_column else [])
    recording = read_recording(args.file, columns, args.time_column)
    reference = reference_curve(args, recording)
    replayed = replay(bench, recording, source, args.set, args.target)
    agreement = judge(args, replayed, reference) if reference else None

    out = args.out or results_folder() / "replay" / args.file.stem
    telemetry = f"replay.{args.format}"
    with output_files(out) as staging:
        write_telemetry(staging / telemetry, replayed, args.every)
        plot_replay(staging / "replay.png", replayed, title_of(args), reference)
    figures = {
        "file": str(args.file),
        **what_was_played(args),
        "rows": recording.rows,
        "rate_Hz": round(recording.rate_Hz, 6),
        "duration_s": round(recording.duration_s, 6),
        **summarize(replayed),
        "reference": agreement_figures(agreement) if agreement else None,
        "outputs": [shown(out / name) for name in (telemetry, "replay.png")],
    }
    if args.json:
        print(json.dumps(figures, indent=1))
    else:
        print_summary(args, figures)
    return 0
