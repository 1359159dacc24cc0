"""`quiesce compare`: laws side by side on recorded ground motions."""

import argparse
import json
from pathlib import Path

from quiesce.base.atomic import output_files
from quiesce.base.command import whole_number
from quiesce.base.paths import shown
from quiesce.cli.rig_options import add_motions, add_rig, records_of, rig_files, shaking_of
from quiesce.compare.clairvoyant import CLAIRVOYANT, Found
from quiesce.compare.goal import INDEX, read_goal
from quiesce.compare.laws import ComparedLaw, read_laws
from quiesce.compare.page import page
from quiesce.compare.records import Record
from quiesce.compare.run import BY_INDEX, Case, Cell, Comparison
from quiesce.compare.table import as_csv, as_data, text
from quiesce.engine.bench import Bench

MOST_SEEDS = 1000
DRAWN = 6  # laws over time, or nothing can be told apart

EPILOG = """a law is NAME[:key=value,...]; keys: table=FILE (quiesce law make), map=FILE (quiesce
identify inverse), rules=FILE, pulses=FILE, as=LABEL, and any parameter of the controller

examples:
  quiesce compare --rig three_storeys_1996 --record quake.csv --time-scale 5 \\
      --law signs:table=build/laws/sky.words,as=skyhook --out build/compare
  quiesce compare --plant my_plant.toml --board my_board.toml --record quake.at2 --scale-to 3 \\
      --law linear:table=optimal.words,tracker=compare --law fuzzy --seeds 5

Beside the laws stand no current, all current, and the best of nine constant currents, which only
hindsight knows. Written to --out: compare.html, compare.csv, compare.json, and with --clairvoyant
clairvoyant_RECORD.csv, the current over time. GOAL of --clairvoyant is index (the default), a
figure such as weighted_m_s2, or several with weights: weighted_m_s2:0.7,tyre_share:0.3; it also
chooses the best constant current.
"""


def add_parser(commands: argparse._SubParsersAction) -> None:
    parser = commands.add_parser(
        "compare",
        description="Compare control laws on one structure, over recorded ground motions and seeds "
        "of the sensors' noise.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    add_rig(parser)
    add_motions(parser)
    parser.add_argument("--law", action="append", default=[], metavar="LAW", help="see below")
    parser.add_argument(
        "--seeds", type=whole_number(1, MOST_SEEDS), default=1, metavar="N",
        help="runs of each with other noise (%(default)s)",
    )  # fmt: skip
    parser.add_argument(
        "--clairvoyant", nargs="?", const=INDEX, metavar="GOAL",
        help="beside each record the best waveform that a search finds, about a minute each",
    )  # fmt: skip
    parser.add_argument("--out", type=Path, metavar="FOLDER", help="page, CSV and JSON")
    parser.add_argument("--json", action="store_true", help="print one JSON object")
    parser.set_defaults(run=run)


def written(
    args: argparse.Namespace, comparison: Comparison, cells: list[Cell],
    laws: list[ComparedLaw], record: Record, found: dict[str, Found],
) -> str:  # fmt: skip
    board = comparison.rig.board
    shown_laws = [*comparison.references(), *laws][:DRAWN]
    traces = {law.label: comparison.trace(Case(law, record, 1)) for law in shown_laws}
    if found:
        traces[CLAIRVOYANT] = found[record.name].trace
    title = f"laws on {board.name}"
    with output_files(args.out) as folder:
        files = {
            "compare.html": page(title, cells, traces, board.bodies[-1], board.dampers[0]),
            "compare.csv": as_csv(cells),
            "compare.json": json.dumps(as_data(cells), indent=1) + "\n",
            **{f"{CLAIRVOYANT}_{name}.csv": one.csv() for name, one in found.items()},
        }
        for name, content in files.items():
            (folder / name).write_text(content, encoding="utf-8")
    more = f", {CLAIRVOYANT}_RECORD.csv" if found else ""
    return f"written: {shown(args.out / 'compare.html')}, compare.csv, compare.json{more}"


def run(args: argparse.Namespace) -> int:
    laws = read_laws(args.law)
    goal = BY_INDEX if args.clairvoyant is None else read_goal(args.clairvoyant)
    plant, board = rig_files(args)
    records = records_of(args)
    comparison = Comparison(Bench(), plant, board, shaking_of(args))
    cells = comparison.cells(laws, records, range(1, args.seeds + 1), goal)
    found: dict[str, Found] = {}
    if args.clairvoyant is not None:
        cells, found = comparison.with_clairvoyant(cells, laws, records, goal)
    told = written(args, comparison, cells, laws, records[0], found) if args.out else ""
    if args.json:
        print(json.dumps({"board": comparison.rig.board.name, "cells": as_data(cells)}, indent=1))
    else:
        print("\n".join(filter(None, [text(cells), told])))
    return 0
