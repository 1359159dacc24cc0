"""`quiesce law fit FILE`: law network fitted to samples of a controller."""

import argparse
import json
from pathlib import Path

from quiesce.base.atomic import output_files
from quiesce.base.command import whole_number
from quiesce.base.paths import shown
from quiesce.engine.bench import Bench
from quiesce.law.fit import KINDS, Fit, fit
from quiesce.law.rig import load_rig
from quiesce.network.layers import MOST_UNITS
from quiesce.table.file import table_bytes

EPILOG = """examples:
  quiesce law fit samples.csv --board my_board.toml --output current_A \\
      --inputs "stroke of brace=x_m,stroke velocity of brace=v_m_s" -o build/laws/net.table
  quiesce law fit samples.csv --board my_board.toml --output i_A --kind rules --units 9 \\
      --inputs "velocity of third,stroke velocity of brace" -o build/laws/rules.table

Imitates whatever made the output of the inputs: another controller, an optimum's waveform. Columns
are in SI units; an input is a signal of the board, with the name of its column where that is
another one. Several outputs are those of the board's dampers, from the first on. What the samples
do not show the network does not know: beyond their range it answers as at its end.

kinds:
"""


def add_parser(actions: argparse._SubParsersAction) -> None:
    kinds = "".join(f"  {name:8}{what}\n" for name, what in KINDS.items())
    parser = actions.add_parser(
        "fit",
        help="a network that imitates a controller, from samples of it",
        description="Fit law network to samples of signals and the current that they should give.",
        epilog=EPILOG + kinds,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("file", type=Path, metavar="FILE", help="CSV with a header line")
    parser.add_argument("--board", type=Path, required=True, metavar="FILE", help="board, TOML")
    parser.add_argument(
        "--inputs", required=True, metavar="SIGNAL[=COLUMN],...", help="what the law sees"
    )
    parser.add_argument(
        "--output", required=True, metavar="COLUMN,...", help="currents in A, one a damper"
    )
    parser.add_argument("--kind", choices=tuple(KINDS), default="tanh", help="(%(default)s)")
    parser.add_argument(
        "--units", type=whole_number(1, MOST_UNITS), default=12, metavar="N",
        help="of the layer (%(default)s)",
    )  # fmt: skip
    parser.add_argument(
        "--seed", type=whole_number(0, (1 << 31) - 1), default=1, metavar="N", help="(%(default)s)"
    )
    parser.add_argument("-o", "--out", type=Path, required=True, metavar="FILE", help="the table")
    parser.add_argument("--json", action="store_true", help="print one JSON object")
    parser.set_defaults(run=run)


def text(made: Fit, words: list[int], args: argparse.Namespace) -> str:
    lines = [f"{args.kind}: {len(words)} words for law network, {shown(args.out)}"]
    for i, (error_A, spread_A) in enumerate(zip(made.error_A, made.spread_A, strict=True)):
        lines.append(
            f"damper {i + 1}   {error_A:.4g} A root mean square on rows that were not fitted; the "
            f"mean current alone {spread_A:.4g} A"
        )
    lines.append(
        f"run it     quiesce_bench run --scenario FILE --board {shown(args.board)} --law network "
        f"--law-table {shown(args.out)}"
    )
    return "\n".join(lines)


def run(args: argparse.Namespace) -> int:
    from quiesce.signal.recording import read_columns

    pairs = [word.strip().partition("=") for word in args.inputs.split(",")]
    signals = [name.strip() for name, _, _ in pairs]
    columns = [(column or name).strip() for name, _, column in pairs]
    outputs = [name.strip() for name in args.output.split(",")]
    rig = load_rig(Bench(), args.board, None, 1000)
    _, values = read_columns(args.file, [*columns, *outputs])
    inputs, currents_A = values[:, : len(columns)], values[:, len(columns) :]
    made = fit(rig, signals, inputs, currents_A, args.kind, args.units, args.seed)
    words = made.table.words()
    with output_files(args.out.parent) as folder:
        (folder / args.out.name).write_bytes(table_bytes(words, rig.board_crc32))
    if args.json:
        data = {"law": "network", "kind": args.kind, "words": len(words)}
        errors = {"error_A": made.error_A, "spread_A": made.spread_A}
        print(json.dumps({**data, **errors}, indent=2))
    else:
        print(text(made, words, args))
    return 0
