"""`quiesce law make RECIPE`: a published law as a table for a board."""

import argparse
import json
from pathlib import Path

from quiesce.base.atomic import output_files
from quiesce.base.paths import shown
from quiesce.engine.bench import Bench
from quiesce.law.recipe import Made, make, values_of
from quiesce.law.recipes import find
from quiesce.law.rig import load_rig
from quiesce.table.file import table_bytes

EPILOG = """examples:
  quiesce law make skyhook_on_off --board my_board.toml -o build/laws/skyhook.table
  quiesce law make clipped_optimal --board my_board.toml --plant my_plant.toml \\
      --set force_1_N2=1e-9 -o build/laws/optimal.table

The table is for this board: its bodies, dampers and sensors. A law that demands forces runs with a
tracker: `inverse` with a damper's map (quiesce identify inverse), `compare` or `proportional` with
a force sensor. `quiesce law list RECIPE` says what can be set.
"""


def add_parser(actions: argparse._SubParsersAction) -> None:
    parser = actions.add_parser(
        "make",
        help="a published law as a table for a board",
        description="Make the table of a published law for a board, and of a plant's matrices "
        "where the law is made from them.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("recipe", metavar="RECIPE", help="one of `quiesce law list`")
    parser.add_argument("--board", type=Path, required=True, metavar="FILE", help="board, TOML")
    parser.add_argument("--plant", type=Path, metavar="FILE", help="plant with matrices, TOML")
    parser.add_argument(
        "--set", action="append", default=[], metavar="NAME=VALUE", help="a setting of the recipe"
    )
    parser.add_argument(
        "--rate", type=int, choices=(500, 1000, 2000, 4000), default=1000, metavar="HZ",
        help="control ticks a second (%(default)s)",
    )  # fmt: skip
    parser.add_argument("-o", "--out", type=Path, required=True, metavar="FILE", help="the table")
    parser.add_argument("--json", action="store_true", help="print one JSON object")
    parser.set_defaults(run=run)


def as_data(made: Made, words: list[int]) -> dict:
    exact = made.compiled
    return {
        "recipe": made.recipe.name,
        "settings": made.values,
        "law": made.table.law,
        "demands": made.table.demands,
        "words": len(words),
        "headroom_dB": exact.headroom_dB if exact and exact.table.states else None,
        "pole_error": exact.pole_error if exact else None,
        "gain_error": exact.gain_error if exact else None,
    }


def text(made: Made, words: list[int], args: argparse.Namespace) -> str:
    lines = [f"{made.recipe.name}: {len(words)} words for law {made.table.law}, {shown(args.out)}"]
    exact = made.compiled
    if exact is not None and exact.table.states:
        lines.append(
            f"states     {len(exact.table.states)}, headroom {exact.headroom_dB:.1f} dB; "
            f"poles within {exact.pole_error:.1e}, gains within {exact.gain_error:.1e}"
        )
    run_it = f"quiesce_bench run --scenario FILE --board {shown(args.board)} --law {made.table.law}"
    tracker = f" --set tracker={made.recipe.tracker}" if made.recipe.tracker else ""
    tracker += " --force-map FILE" if made.recipe.tracker == "inverse" else ""
    lines.append(f"run it     {run_it} --law-table {shown(args.out)}{tracker}")
    return "\n".join(lines)


def run(args: argparse.Namespace) -> int:
    recipe = find(args.recipe)
    values = values_of(recipe, args.set)
    rig = load_rig(Bench(), args.board, args.plant, args.rate)
    made = make(recipe, rig, values)
    words = made.table.words()
    with output_files(args.out.parent) as folder:
        (folder / args.out.name).write_bytes(table_bytes(words, rig.board_crc32))
    print(json.dumps(as_data(made, words), indent=2) if args.json else text(made, words, args))
    return 0
