"""`quiesce compare`: laws side by side on recorded ground motions."""

import argparse
import json
import re
import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from quiesce.base.atomic import output_files
from quiesce.base.command import whole_number
from quiesce.base.errors import UsageError, one_line
from quiesce.base.paths import shown
from quiesce.cli.file_format import add_format, require_format
from quiesce.cli.rig_options import add_motions, add_rig, records_of, several_rig_files, shaking_of
from quiesce.cli.terminal import show
from quiesce.compare.clairvoyant import CLAIRVOYANT, Found
from quiesce.compare.goal import INDEX, read_goal
from quiesce.compare.laws import ComparedLaw, read_law, require_labels
from quiesce.compare.page import Shown, page
from quiesce.compare.recipes import read_recipe
from quiesce.compare.records import Record
from quiesce.compare.run import BY_INDEX, Case, Cell, Comparison
from quiesce.compare.table import as_csv, as_data, text
from quiesce.engine.bench import Bench
from quiesce.law.rig import load_rig
from quiesce.recording.write import write_columns

MOST_SEEDS = 1000
DRAWN = 6  # laws over time, or nothing can be told apart
RATE_HZ = 1000  # ticks a second of recipes

EPILOG = """a law is NAME[:key=value,...]; keys: table=FILE (quiesce law make), map=FILE (quiesce
identify inverse), rules=FILE, pulses=FILE, as=LABEL, and any parameter of the controller

a recipe is NAME[:key=value,...], one of `quiesce law list`; keys: its settings, map=FILE, as=LABEL,
and any parameter of the controller (tracker, where it is not to be the recipe's own). With several
structures a recipe is left out, with the reason, where one cannot serve it

examples:
  quiesce compare --rig three_storeys_1996 --time-scale 5 --scale-to 3.417 \\
      --recipe skyhook_on_off --recipe clipped_optimal:force_1_N2=1e-10 --clairvoyant
  quiesce compare --rig quarter_car --rig two_storeys --road C:72 --recipe sh_add --recipe add
  quiesce compare --rig three_storeys_1996 --record quake.csv --time-scale 5 \\
      --law signs:table=build/laws/sky.table,as=skyhook --out build/compare
  quiesce compare --plant my_plant.toml --board my_board.toml --record quake.at2 --scale-to 3 \\
      --law linear:table=optimal.table,tracker=compare --law fuzzy --seeds 5

Beside the laws stand no current, all current, and the best of nine constant currents, which only
hindsight knows. Written to --out: compare.html, compare.csv, compare.json; with --clairvoyant
clairvoyant_RECORD.csv, the current over time; with --format history_RECORD_LAW, what the page
draws. GOAL of --clairvoyant is index (the default), a figure such as weighted_m_s2, or several with
weights: weighted_m_s2:0.7,tyre_share:0.3; it also chooses the best constant current.
"""


def add_parser(commands: argparse._SubParsersAction) -> None:
    parser = commands.add_parser(
        "compare",
        description="Compare control laws on structures, over recorded ground motions and seeds "
        "of the sensors' noise.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    add_rig(parser, several=True)
    add_motions(parser)
    parser.add_argument("--law", action="append", default=[], metavar="LAW", help="see below")
    parser.add_argument(
        "--recipe", action="append", default=[], metavar="RECIPE",
        help="a published law, made for each structure; see below",
    )  # fmt: skip
    parser.add_argument(
        "--seeds", type=whole_number(1, MOST_SEEDS), default=1, metavar="N",
        help="runs of each with other noise (%(default)s)",
    )  # fmt: skip
    parser.add_argument(
        "--clairvoyant", nargs="?", const=INDEX, metavar="GOAL",
        help="beside each record the best waveform that a search finds, about a minute each",
    )  # fmt: skip
    parser.add_argument("--out", type=Path, metavar="FOLDER", help="page, CSV and JSON")
    add_format(parser, "what laws did over time, a file each, which are then written, too", None)
    parser.add_argument("--json", action="store_true", help="print one JSON object")
    parser.set_defaults(run=run)


@dataclass(frozen=True)
class OfRig:
    """What ran on one structure, and what was left out there, a line each."""

    comparison: Comparison
    laws: list[ComparedLaw]
    cells: list[Cell]
    found: dict[str, Found]
    left_out: list[str]

    def shown(self, record: Record) -> Shown:
        board = self.comparison.rig.board
        laws = [*self.comparison.references(), *self.laws][:DRAWN]
        traces = {law.label: self.comparison.trace(Case(law, record, 1)) for law in laws}
        if self.found:
            traces[CLAIRVOYANT] = self.found[record.name].trace
        return Shown(board.name, self.cells, traces, board.bodies[-1], board.dampers[0])


def histories(
    args: argparse.Namespace, rigs: list[OfRig], drawn: list[Shown], record: Record
) -> dict[str, dict[str, np.ndarray]]:
    """By the stem of a file: the clairvoyant's currents; with --format what the page draws, too."""
    files = {}
    for one, of_rig in zip(rigs, drawn, strict=True):
        rig = [one.comparison.rig.board.name] if len(rigs) > 1 else []
        for name, found in one.found.items():
            files["_".join([CLAIRVOYANT, *rig, name])] = found.columns()
        if args.format:
            for label, trace in of_rig.traces.items():
                stem = "_".join(["history", *rig, record.name, label])
                files[re.sub(r"[^\w.+-]", "_", stem)] = {"t_s": trace["t_s"], **trace}
    return files


def written(args: argparse.Namespace, rigs: list[OfRig], record: Record) -> str:
    cells = [cell for one in rigs for cell in one.cells]
    drawn = [one.shown(record) for one in rigs]
    files = {
        "compare.html": page(drawn),
        "compare.csv": as_csv(cells),
        "compare.json": json.dumps(as_data(cells), indent=1) + "\n",
    }
    over_time = histories(args, rigs, drawn, record)
    ending = args.format or "csv"
    with output_files(args.out) as folder:
        for name, content in files.items():
            (folder / name).write_text(content, encoding="utf-8")
        for stem, columns in over_time.items():
            write_columns(folder / f"{stem}.{ending}", columns)
    others = [*list(files)[1:], *(f"{stem}.{ending}" for stem in over_time)]
    return f"written: {', '.join([shown(args.out / 'compare.html'), *others])}"


def on_rig(
    args: argparse.Namespace, files: tuple[Path, Path], records: list[Record], folder: Path,
    may_leave_out: bool,
) -> OfRig:  # fmt: skip
    """UsageError where the structure cannot serve a recipe, unless that one may be left out."""
    plant, board = files
    laws = [read_law(text) for text in args.law]
    left_out: list[str] = []
    recipes = [read_recipe(text) for text in args.recipe]
    rig = load_rig(Bench(), board, plant, RATE_HZ) if recipes else None
    for recipe in recipes:
        try:
            laws.append(recipe.law(rig, folder))
        except UsageError as error:
            if not may_leave_out:
                raise
            left_out.append(f"left out: {one_line(str(error))}")
    require_labels([law.label for law in laws])
    goal = BY_INDEX if args.clairvoyant is None else read_goal(args.clairvoyant)
    comparison = Comparison(Bench(), plant, board, shaking_of(args))
    cells = comparison.cells(laws, records, range(1, args.seeds + 1), goal)
    found: dict[str, Found] = {}
    if args.clairvoyant is not None:
        cells, found = comparison.with_clairvoyant(cells, laws, records, goal)
    return OfRig(comparison, laws, cells, found, left_out)


def run(args: argparse.Namespace) -> int:
    if args.format and not args.out:
        raise UsageError("--format says how files are written; --out FOLDER says where")
    require_format(args)
    files = several_rig_files(args)
    records = records_of(args)
    with tempfile.TemporaryDirectory(prefix="quiesce-compare-") as name:
        rigs = [on_rig(args, one, records, Path(name), len(files) > 1) for one in files]
        told = written(args, rigs, records[0]) if args.out else ""
    cells = [cell for one in rigs for cell in one.cells]
    left_out = [line for one in rigs for line in one.left_out]
    if args.json:
        names = [one.comparison.rig.board.name for one in rigs]
        print(json.dumps({"rigs": names, "left_out": left_out, "cells": as_data(cells)}, indent=1))
    else:
        show("\n".join(filter(None, [text(cells), *left_out, told])))
    return 0
