"""`quiesce report BEFORE AFTER`: what changed between two recordings, as a page to hand over."""

import argparse
import json
from dataclasses import replace
from pathlib import Path

from quiesce.base.atomic import output_files
from quiesce.base.command import real_number, whole_number
from quiesce.base.errors import EXIT_FAILED, UsageError
from quiesce.base.paths import results_folder, results_text, shown
from quiesce.base.table import format_table
from quiesce.before_after.data import as_data
from quiesce.before_after.files.open_file import How, open_file
from quiesce.before_after.limits import read_limits
from quiesce.before_after.motion import Wanted, wanted
from quiesce.before_after.page import band_text, page, verdicts
from quiesce.before_after.run import Options, Report, compared
from quiesce.before_after.words import HEAD, headline, rows
from quiesce.cli.terminal import show
from quiesce.compare.zones import SLOW_BAND_Hz, machines

PAGE, DATA = "report.html", "report.json"
MOST_Hz = 1e6

EPILOG = """examples:
  quiesce report before.mf4 after.mf4
  quiesce report before.csv after.csv --channel roof --reference base --limits limits.toml
  quiesce report before.csv after.csv --channel acc:g --band 1 200 --out handover.html
  quiesce report a.mf4 b.mf4 --channel 'Acc 1=Acc_1:m/s2' --machine medium:rigid
  quiesce report before.mf4 after.mf4 --channel AccelSample:0.0012*m/s2 --json

Reads CSV (a header whose names end in units: acc_g, "roof (mm/s)"), MF4 and MDF of data loggers,
MAT, UFF, LVM, HDF5, Parquet, logs of the controller's bus (quiesce can record --raw: .mf4 .log .asc
.blf .csv .trc) and traces of the bench. Channels that both files have with a unit of acceleration,
velocity or displacement are compared, in SI units; --channel chooses, and states a unit that a file
does not have.

Written: report.html and report.json in build/report/before_after, or --out. What is doubtful is
told in the page and here: gaps, clipping, drift, records that are not stationary, another input.
Exit code 1 where a limit of --limits is missed, 2 where the input is no use.
"""


def add_parser(commands: argparse._SubParsersAction) -> None:
    parser = commands.add_parser(
        "report",
        description="Compare two recordings of a structure: RMS and peaks with intervals, third\n"
        "octaves, transmissibility, zones, limits; a page to hand to a customer.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("before", type=Path, metavar="BEFORE", help="recording, as without control")
    parser.add_argument("after", type=Path, metavar="AFTER", help="recording, as with it")
    parser.add_argument(
        "--channel", action="append", default=[], metavar="NAME[=NAME][:UNIT]",
        help="what to compare, repeatable (all with a known unit in both); BEFORE=AFTER where the "
        "names differ; the unit may have a factor: counts:0.0012*m/s2",
    )  # fmt: skip
    parser.add_argument(
        "--reference", metavar="NAME[=NAME][:UNIT]",
        help="the input's channel, as the base: adds transmissibility and figures under one input",
    )  # fmt: skip
    parser.add_argument(
        "--band", nargs=2, type=real_number(1e-6, MOST_Hz), metavar=("LOW", "HIGH"),
        help="Hz of all figures (from 0.5 Hz or 20 periods of the shorter record, to 0.4 of the "
        "lower rate)",
    )  # fmt: skip
    parser.add_argument("--limits", type=Path, metavar="FILE.toml", help="what has to be kept")
    parser.add_argument(
        "--machine", choices=list(machines()), help="zones A to D as ISO 20816-3 has them"
    )
    parser.add_argument(
        "--slow", action="store_true", help="a machine below 600 rpm: zones from 2 Hz on"
    )
    parser.add_argument("--comfort", action="store_true", help="RMS through Wk of ISO 2631-1, too")
    parser.add_argument("--title", default=Options.title, help="of the page (%(default)s)")
    parser.add_argument(
        "--out", type=Path, metavar="FOLDER|PAGE.html",
        help=f"where to write ({results_text('report/before_after')})",
    )  # fmt: skip
    parser.add_argument("--json", action="store_true", help="print all figures as JSON")
    add_csv_options(parser.add_argument_group("CSV files"))
    parser.set_defaults(run=run)


def add_csv_options(group: argparse._ArgumentGroup) -> None:
    group.add_argument("--time", metavar="NAME[:UNIT]", help="column of time (found by its name)")
    group.add_argument(
        "--rate-hz", type=real_number(1e-3, MOST_Hz), metavar="R", help="of files without one"
    )
    group.add_argument(
        "--skip-lines", type=whole_number(0, 1_000_000), default=0, metavar="N",
        help="lines above the header",
    )  # fmt: skip


def options_of(args: argparse.Namespace) -> Options:
    machine = machines()[args.machine] if args.machine else None
    if args.slow:
        if machine is None:
            raise UsageError("--slow is of a machine's zones; name it, too: --machine")
        machine = replace(machine, band_Hz=SLOW_BAND_Hz)
    reference: Wanted | None = None
    if args.reference is not None:
        reference = wanted("--reference", args.reference)
    return Options(
        channels=[wanted("--channel", text) for text in args.channel],
        reference=reference,
        band_Hz=tuple(args.band) if args.band else (None, None),
        machine=machine,
        has_comfort=args.comfort,
        limits=read_limits(args.limits) if args.limits else (),
        title=args.title,
    )


def text(report: Report) -> str:
    parts = [band_text(report)]
    parts += [headline(one) for one in report.channels]
    for one in report.channels:
        parts.append(f"\n{one.pair.name}\n" + format_table(HEAD, rows(one), left=(0, 1)))
        if one.zones:
            parts.append(f"zone {one.zones[0]} before, {one.zones[1]} after")
    if (judged := verdicts(report)) is not None:
        parts.append("\n" + format_table(*judged, left=range(6)))
    of_channels = [f"{one.pair.name}: {line}" for one in report.channels for line in one.doubts]
    doubts = [f"- {line}" for line in [*report.doubts, *of_channels]]
    return "\n".join([*parts, *(["", "to keep in mind:", *doubts] if doubts else [])])


def place_of(out: Path) -> tuple[Path, str]:
    """Folder and the page's name there. A name that ends in .html takes the page alone."""
    return (out.parent, out.name) if out.suffix.lower() in (".html", ".htm") else (out, PAGE)


def run(args: argparse.Namespace) -> int:
    options = options_of(args)
    how = How(args.time, args.rate_hz, args.skip_lines)
    out = args.out or results_folder() / "report/before_after"
    folder, name = place_of(out)
    # Opened before the work, so that a folder that cannot be written is known at once.
    with output_files(folder) as staging:
        report = compared(open_file(args.before, how), open_file(args.after, how), options)
        data = json.dumps(as_data(report), indent=1)
        (staging / name).write_text(page(report), encoding="utf-8")
        if folder == out:
            (staging / DATA).write_text(data + "\n", encoding="utf-8")
    if args.json:
        print(data)
    else:
        show(f"{text(report)}\n\nwritten: {shown(folder / name)}")
    return 0 if report.is_kept else EXIT_FAILED
