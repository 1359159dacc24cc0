"""`./tools/benchmark can`: bus load, response times from the DBC, the rest in a virtual machine."""

import argparse
import os
from pathlib import Path
from typing import Any

from quiesce.base.errors import UsageError
from quiesce.base.table import format_table

from quiesce_benchmarks.images import build
from quiesce_benchmarks.report import Figure, Report

NAME = "can"
HELP = "the CAN interface: bus load, response times, the Linux controller in a virtual machine"
DESCRIPTION = """Computes bus load and worst-case response times from quiesce.dbc, then boots the
Linux controller in a virtual machine (an arm64 kernel under QEMU) and measures there: frames lost,
emergency stop, bit equality with the host, lateness beside cyclictest's. Nothing that is measured
in emulation says how a real board keeps its time."""

BITRATE = 500_000
DEMAND = "CurrentDemand"
# Of the virtual machine: name, unit, goal.
VM_FIGURES = (
    ("vm_frames_lost", "frames", 0.0),
    ("estop_ticks", "ticks", 2.0),
    ("vm_trace_mismatches", "ticks", 0.0),
    ("lateness_over_cyclictest", "1", 1.5),
    ("vm_seconds", "s", None),
)


def add_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--no-vm", action="store_true", help="only what is computed; the rest counts as absent"
    )


def computed_figures() -> tuple[list[Figure], dict[str, float], list[str]]:
    """Figures that follow from the DBC; all loads; tables of the loads and the messages."""
    from quiesce.can import bus_load
    from quiesce.can.database import load as load_database

    database = load_database()
    totals = bus_load.totals_pct(database, BITRATE)
    analysis = bus_load.Analysis(bus_load.on_bus(database), BITRATE)
    _, baud = bus_load.baud_needed(bus_load.slcan_messages(database))
    figures = [
        Figure("bus_load_pct", totals["cyclic"], "%", 34.0, "lower"),
        Figure("bus_load_raw_pct", totals["with_raw"], "%", 62.0, "lower"),
        Figure("demand_response_ms", analysis.response_ms(DEMAND), "ms", 0.55, "lower"),
        Figure("slcan_baud_needed", baud, "baud", None, "lower"),
    ]
    rows = []
    for stream in analysis.streams:
        response_ms = analysis.response_ms(stream.message.name)
        bound = "no bound" if response_ms is None else f"{response_ms:.3f}"
        rows.append([stream.message.name, str(stream.bits), str(stream.message.period_ms), bound])
    table = format_table(["message, sensor node too", "bits", "period ms", "response ms"], rows)
    return figures, totals, [bus_load.totals_table(totals, BITRATE), table]


def vm_figures(args: argparse.Namespace) -> tuple[dict[str, Any], list[str]]:
    """Values by name, and why there are none."""
    if args.no_vm:
        return {}, ["virtual machine: left out (--no-vm)"]
    from quiesce_vm.measure import measure

    try:
        if not os.environ.get("QUIESCE_BUILD"):
            build("tests/system/vm/build_images", "all")
        return dict(measure()), []
    except UsageError as error:  # QEMU or a package is absent
        return {}, [f"virtual machine: {error}"]


def measure(args: argparse.Namespace, folder: Path) -> Report:
    figures, totals, tables = computed_figures()
    values, absent = vm_figures(args)
    figures += [
        Figure(name, values.get(name), unit, goal, "lower") for name, unit, goal in VM_FIGURES
    ]
    context = {"bitrate": BITRATE, "load_pct": totals}
    context |= {k: v for k, v in values.items() if k not in names()}
    return Report(NAME, figures, context, tables, absent)


def names() -> set[str]:
    return {name for name, _, _ in VM_FIGURES}
