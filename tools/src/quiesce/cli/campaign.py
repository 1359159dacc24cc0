"""`quiesce campaign FILE`: thousands of cases, on all processors or a cluster, resumable."""

import argparse
import json
import os
import shlex
import sys
from pathlib import Path
from typing import Any

from quiesce.base.atomic import output_files
from quiesce.base.command import whole_number
from quiesce.base.errors import EXIT_FAILED, EXIT_INTERRUPTED, UsageError
from quiesce.base.paths import results_folder, results_text, shown
from quiesce.base.pools import Pool, pool_of
from quiesce.base.progress import say
from quiesce.base.table import format_table
from quiesce.campaign import tables
from quiesce.campaign.facts import facts_of
from quiesce.campaign.file import Campaign, read_campaign
from quiesce.campaign.run import run_missing
from quiesce.campaign.store import NAME, Store, claimed
from quiesce.campaign.summary import Summary, as_data, summary_of
from quiesce.campaign.worker import Row, Worker, write_files
from quiesce.cli.campaign_progress import CampaignProgress
from quiesce.cli.terminal import show

PAGE, DATA = "campaign.html", "campaign.json"
MOST_WORKERS = 1024

EPILOG = """examples:
  quiesce campaign examples/campaign/spread.toml
  quiesce campaign my.toml --workers 8 --out results/my
  quiesce campaign my.toml --dask tcp://head:8786    a running cluster of Dask
  quiesce campaign my.toml --dask local              one of this machine
  quiesce campaign my.toml --case 4711               that case alone, as in the store
  quiesce campaign my.toml --case 4711 --files bad   its plant and scenario as files, too

FILE says what is varied and how: docs/howto/campaign.md. Written to --out: campaign.sqlite, a row a
case, as chunks are finished; at the end campaign.html and campaign.json. The same command goes on
where one ended, however that ended. A case that fails is a row with its reason. Exit code 1 where
all cases failed.
"""


def add_parser(commands: argparse._SubParsersAction) -> None:
    parser = commands.add_parser(
        "campaign",
        description="Run grids and samples of plants, dampers, laws, boards, excitations, faults, "
        "and of\ntheir parameters on the bench: distributions, worst cases, sensitivities.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("file", type=Path, metavar="FILE", help="the campaign")
    parser.add_argument(
        "--out", type=Path, metavar="FOLDER",
        help=f"store and page ({results_text('campaign')}/NAME)",
    )  # fmt: skip
    parser.add_argument(
        "--workers", type=whole_number(1, MOST_WORKERS), metavar="N",
        help="processes (one for each processor)",
    )  # fmt: skip
    parser.add_argument(
        "--dask", metavar="ADDRESS|local", help="run on a cluster of Dask; extra 'cluster'"
    )
    parser.add_argument(
        "--case", type=whole_number(0, 10**9), metavar="N", help="run this one alone, store nothing"
    )
    parser.add_argument(
        "--files", type=Path, metavar="FOLDER", help="with --case: write the case's files there"
    )
    parser.add_argument("--json", action="store_true", help="print one JSON object")
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    if args.files is not None and args.case is None:
        raise UsageError("--files is of one case: name it, too, --case N")
    campaign = read_campaign(args.file)
    return run_one(args, campaign) if args.case is not None else run_all(args, campaign)


def run_all(args: argparse.Namespace, campaign: Campaign) -> int:
    folder = args.out or results_folder() / "campaign" / campaign.file.stem
    facts = facts_of(campaign)
    # A cluster that does not answer is told before anything is written.
    pool = pool_of(args.dask, args.workers or os.cpu_count() or 1)
    try:
        with claimed(folder):
            names = [factor.name for factor in campaign.design.factors]
            store = Store(folder / NAME, names, campaign.recipe.figures, facts)
            return completed(args, campaign, store, pool)
    finally:
        pool.close()


def completed(args: argparse.Namespace, campaign: Campaign, store: Store, pool: Pool) -> int:
    folder, total = store.file.parent, len(campaign.design)
    try:
        if (known := store.count()) < total:
            with CampaignProgress(total, known, store.failed()) as progress:
                run_missing(campaign, store, pool, progress.done)
        summary = summary_of(campaign, store)
    except KeyboardInterrupt:
        say(
            f"quiesce: interrupted; {store.count()} of {total} cases are in {shown(folder)}, "
            "the same command goes on"
        )
        return EXIT_INTERRUPTED
    finally:
        store.close()
    data = json.dumps(as_data(summary), indent=1)
    write_report(folder, summary, data)
    written = f"written: {shown(folder / PAGE)}, {DATA}, {NAME}"
    show(data if args.json else f"{text(summary)}\n\n{written}")
    return EXIT_FAILED if summary.failed == total else 0


def write_report(folder: Path, summary: Summary, data: str) -> None:
    from quiesce.campaign.page import page

    with output_files(folder) as staging:
        (staging / PAGE).write_text(page(summary), encoding="utf-8")
        (staging / DATA).write_text(data + "\n", encoding="utf-8")


def text(summary: Summary) -> str:
    design = summary.campaign.design
    failed = f", {summary.failed} failed" if summary.failed else ""
    parts = [f"{summary.campaign.name}: {design.method}, {summary.cases} cases{failed}"]
    parts.append(format_table(*tables.distributions(summary), left=(0, 1)))
    for (figure, group), one in summary.sensitivities.items():
        parts.append(f"what {figure} depends on, {group} ({one.note})\n"
                     + format_table(*tables.sensitivity(one), left=(0,)))  # fmt: skip
    if summary.worst:
        parts.append("worst cases\n" + format_table(*tables.worst(summary), left=(1,)))
        parts.append("one of them alone: " + summary.worst[0].replay)
    if summary.reasons:
        parts.append("failed\n" + format_table(*tables.failures(summary), left=(0,)))
    return "\n\n".join(parts)


def run_one(args: argparse.Namespace, campaign: Campaign) -> int:
    """Exit code 1 where the case fails."""
    total = len(campaign.design)
    if args.case >= total:
        raise UsageError(f"--case {args.case}: the campaign has cases 0 .. {total - 1}")
    case = campaign.design.case(args.case)
    options: list[str] = []
    if args.files is not None:
        with output_files(args.files) as staging:
            options = write_files(campaign.recipe.parts(case), staging, args.files)
    worker = Worker()
    row = worker.row(campaign.recipe, case)
    worker.close()
    data = row_data(campaign, row)
    if args.json:
        print(json.dumps(data, indent=1))
    else:
        lines = [(name, tables.told(value)) for name, value in data.items()]
        show(format_table(("", f"case {args.case}"), lines, left=(0,)))
        if options:
            show("\nquiesce_bench run " + shlex.join(options))
    if row.reason:
        print(f"quiesce: {row.reason}", file=sys.stderr)
    return EXIT_FAILED if row.reason else 0


def row_data(campaign: Campaign, row: Row) -> dict[str, Any]:
    """As the store's columns have it."""
    names = [factor.name for factor in campaign.design.factors]
    blank = (None,) * len(campaign.recipe.figures)
    return {
        "number": row.number,
        "seed": row.seed,
        **dict(zip(names, row.labels, strict=True)),
        "reason": row.reason,
        "telemetry_crc32": row.crc32,
        **dict(zip(campaign.recipe.figures, row.figures or blank, strict=True)),
    }
