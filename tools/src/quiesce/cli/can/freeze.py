"""`quiesce can freeze`: the record of a fault, from the controller into a table and a picture."""

import argparse
import json
import sys
from pathlib import Path
from typing import Any

from quiesce.base.atomic import output_files
from quiesce.base.paths import results_folder, results_text, shown
from quiesce.cli.can.bus_options import add_bus_options, bus_of

EPILOG = """examples:
  quiesce can freeze --bus socketcan:can0
  quiesce can freeze --out incident --bus slcan:/dev/ttyACM0
  quiesce can freeze --clear --bus socketcan:can0

The second before the first fault and what followed, eight signals with their least and greatest
value every 20 ms. Written: record.csv, record.json, record.png, record.bin (as the controller keeps
it). Pages that are lost are asked for again. The record stays until an operator has acknowledged
the fault and the next one comes; --clear forgets it once it is written. Exit code 1 where there is
none. docs/reference/can-messages.md explains it.
"""


def add_parser(commands: argparse._SubParsersAction) -> None:
    parser = commands.add_parser(
        "freeze",
        help="the record of a fault",
        description="Fetch the record of a fault: a table and a picture of the second before it.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument(
        "--out", type=Path, metavar="DIR", help=f"({results_text('report/freeze')})"
    )
    parser.add_argument("--clear", action="store_true", help="then the controller forgets it")
    parser.add_argument("--json", action="store_true", help="print JSON")
    add_bus_options(parser)
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    from quiesce.can.database import load
    from quiesce.can.fault_record import Fetch
    from quiesce.can.link import Link

    database = load()
    out = args.out or results_folder() / "report" / "freeze"
    with Link(bus_of(args)) as link:
        fetch = Fetch(link, database, None if args.json else tell)
        record, fetched = fetch.record()
        figures = figures_of(record, fetched.later, database)
        write(out, record, fetched.data, figures)
        if args.clear:
            fetch.clear()
    if args.json:
        print(json.dumps(figures, indent=1))
    else:
        print_summary(figures, out)
    return 0


def tell(done: int, total: int) -> None:
    print(f"quiesce: {done} of {total} pages", file=sys.stderr, flush=True)


def figures_of(record: Any, later: int, database: Any) -> dict[str, Any]:
    return {
        "number": record.number,
        "fault": database.label("FaultFreeze", "freeze_fault", record.fault),
        "state_before": database.label("FaultFreeze", "freeze_state", record.state_before),
        "is_latched": record.is_latched,
        "tick": record.tick,
        "tick_rate_Hz": record.tick_rate_Hz,
        "fault_bin": record.fault_bin,
        "param_hash": f"{record.param_hash:08x}",
        "table_hash": f"{record.table_hash:08x}",
        "version": record.version,
        "interface_version": record.interface_version,
        "fault_count": record.fault_count,
        "accel_counts": record.accel_counts,
        "ticks_lost": record.ticks_lost,
        "samples_refused": record.samples_refused,
        "law": record.law,
        "damper": record.damper,
        "later_faults": later,
    }


def write(out: Path, record: Any, data: bytes, figures: dict[str, Any]) -> None:
    from quiesce.can.fault_record import csv_lines

    with output_files(out) as staging:
        (staging / "record.bin").write_bytes(data)
        (staging / "record.csv").write_text("\n".join(csv_lines(record)) + "\n", encoding="utf-8")
        (staging / "record.json").write_text(json.dumps(figures, indent=1) + "\n", encoding="utf-8")
        plot(staging / "record.png", record, figures)


def plot(path: Path, record: Any, figures: dict[str, Any]) -> None:
    """A panel a signal: its band, and the bin of the fault."""
    from quiesce.can.fault_record import BINS_HZ, SIGNALS
    from quiesce.report.plot_style import COLORS, pyplot

    plt = pyplot()
    figure, axes = plt.subplots(4, 2, figsize=(9, 8), sharex=True)
    for i, (axis, signal) in enumerate(zip(axes.T.flat, SIGNALS, strict=True)):
        rows = [
            (time_s, band[0] * signal.scale, band[1] * signal.scale)
            for time_s, bins in zip(record.times_s, record.bins, strict=True)
            if (band := bins[i]) is not None
        ]
        axis.axvspan(0.0, 1.0 / BINS_HZ, color=COLORS["reference"], alpha=0.6, linewidth=0)
        for time_s, low, high in rows:
            ends = [time_s, time_s + 1.0 / BINS_HZ]
            axis.fill_between(ends, low, high, color=COLORS["main"], alpha=0.4, linewidth=0)
            axis.plot(ends, [low, low], color=COLORS["main"], linewidth=0.8)
            axis.plot(ends, [high, high], color=COLORS["main"], linewidth=0.8)
        unit = f" ({signal.unit})" if signal.unit else ""
        axis.set_title(signal.title + unit + ("" if rows else ": no value"))
    for axis in axes[-1]:
        axis.set_xlabel("time from the fault (s)")
    figure.suptitle(
        f"{figures['fault']} in state {figures['state_before']}, tick {figures['tick']}"
    )
    figure.savefig(path)
    plt.close(figure)


def print_summary(figures: dict[str, Any], out: Path) -> None:
    print(
        f"fault     {figures['fault']} in state {figures['state_before']}, tick {figures['tick']}; "
        f"{figures['later_faults']} later ones were not recorded\n"
        f"firmware  {figures['version']}, parameters {figures['param_hash']}, "
        f"table {figures['table_hash']}\n"
        f"written   {shown(out / 'record.csv')}, .json, .png, .bin"
    )
