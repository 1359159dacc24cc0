"""`quiesce rules diff A B`: where two rule bases differ, in words, figures and pictures."""

import argparse
import json
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from quiesce.base.atomic import output_files
from quiesce.base.command import real_number
from quiesce.base.errors import EXIT_FAILED
from quiesce.base.paths import results_folder, results_text, shown
from quiesce.cli.rules.show import add_reading_options, slice_of, tell_notes
from quiesce.report.page import render
from quiesce.rules.analysis.findings import number
from quiesce.rules.formats.files import read_rules
from quiesce.rules.model import RuleBase
from quiesce.rules.views.compare import (
    OutputDifference,
    compare_outputs,
    make_grid,
    matched,
)
from quiesce.rules.views.diff_plots import plot_difference
from quiesce.rules.views.plots import file_name, save
from quiesce.rules.views.structure import structural_differences
from quiesce.rules.views.surface import Slice

EPILOG = """examples:
  quiesce rules diff old.fcl new.fcl
  quiesce rules diff controller.fis controller.fcl --threshold 0.01
  quiesce rules diff a.fcl b.fcl --json

Inputs and outputs are matched by name. The outputs are compared in float64 over the universes of
both, on a grid with every breakpoint of both, and the largest difference is refined from there.
With more than two inputs the pictures go through the largest difference, unless --at holds an
input elsewhere. Written: index.html (self-contained) and one picture an output, as PNG and SVG.

Exit codes: 0 the same outputs everywhere on the grid, however they are written down; 1 they
differ by more than rounding (1e-9 of the output's range) somewhere; 2 bad input.
"""


@dataclass(frozen=True)
class Comparison:
    one: RuleBase
    other: RuleBase
    said: Sequence[str]  # structural differences
    outputs: Sequence[OutputDifference]
    points: int  # of the grid

    @property
    def is_same(self) -> bool:
        return all(output.is_same for output in self.outputs)


def add_parser(actions: argparse._SubParsersAction) -> None:
    parser = actions.add_parser(
        "diff",
        help="where two rule bases differ",
        description="Compare two rule bases: what they say, and what comes out.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("a", metavar="A", type=Path, help="rule file: .fcl, .fll, .fis or .t2fis")
    parser.add_argument("b", metavar="B", type=Path, help="another one")
    parser.add_argument(
        "--threshold", type=real_number(0.0, math.inf), metavar="X",
        help="share of the inputs where outputs differ by more than X in their unit "
        "(a thousandth of the output's range)",
    )  # fmt: skip
    add_reading_options(parser)
    parser.add_argument(
        "--out",
        type=Path,
        metavar="DIR",
        help=f"folder to write to ({results_text('rules/diff/A_B')})",
    )
    parser.add_argument("--json", action="store_true", help="print the differences as JSON")
    parser.set_defaults(run=run)


def read_pair(args: argparse.Namespace) -> tuple[RuleBase, RuleBase]:
    """Named by their files; the second one in the order of the first."""
    one, other = (
        replace(read_rules(file, args.approximate), name=shown(file)) for file in (args.a, args.b)
    )
    for base in (one, other):
        tell_notes(base, base.name)
    return one, matched(one, other)


def slice_at(args: argparse.Namespace, one: RuleBase, found: OutputDifference) -> Slice:
    """As the user asked for; inputs not held by them stand where the difference is largest."""
    cut = slice_of(args, one)
    named = {setting.partition("=")[0] for setting in args.at}
    held = tuple(
        value if variable.name in named else at
        for variable, value, at in zip(one.inputs, cut.held, found.at, strict=True)
    )
    return replace(cut, held=held)


def place_text(base: RuleBase, at: Sequence[float]) -> str:
    return ", ".join(
        f"{variable.name} = {number(x)}" for variable, x in zip(base.inputs, at, strict=True)
    )


def value_text(value: float) -> str:
    return "no value" if math.isnan(value) else number(value)


def output_text(one: RuleBase, found: OutputDifference) -> str:
    if found.is_same:
        return f"{found.name}: the same everywhere on the grid (within {found.largest:.1g})"
    size = (
        "one of them has no value"
        if math.isinf(found.largest)
        else f"{found.largest:.4g} ({100 * found.largest / found.range:.3g} % of its range)"
    )
    a, b = (value_text(value) for value in found.values)
    lines = [
        f"{found.name}: largest difference {size}, at {place_text(one, found.at)}: A {a}, B {b}",
        f"   beyond {number(found.threshold)}: {100 * found.share_beyond:.3g} % of the inputs",
    ]
    if found.share_default > 0:
        lines.append(
            f"   only one of them is at its default: {100 * found.share_default:.3g} % of the "
            "inputs"
        )
    return "\n".join(lines)


def report(found: Comparison) -> str:
    lines = [f"A {found.one.name}", f"B {found.other.name}", ""]
    if found.said:
        lines += ["what they say"] + [f"   {line}" for line in found.said]
    else:
        lines.append("they say the same")
    lines += ["", f"what comes out, on {found.points} points"]
    lines += [f"   {line}" for o in found.outputs for line in output_text(found.one, o).split("\n")]
    if found.is_same:
        lines += ["", "same meaning"]
    return "\n".join(lines)


def json_object(found: Comparison) -> dict[str, Any]:
    names = [variable.name for variable in found.one.inputs]
    return {
        "a": found.one.name,
        "b": found.other.name,
        "same": found.is_same,
        "structure": list(found.said),
        "points": found.points,
        "outputs": [
            {
                "name": output.name,
                "same": output.is_same,
                "largest": finite(output.largest),
                "at": dict(zip(names, output.at, strict=True)),
                "a": finite(output.values[0]),
                "b": finite(output.values[1]),
                "threshold": output.threshold,
                "beyond_pct": round(100 * output.share_beyond, 6),
                "one_default_pct": round(100 * output.share_default, 6),
            }
            for output in found.outputs
        ],
    }


def finite(value: float) -> float | None:
    return value if math.isfinite(value) else None


def write_files(folder: Path, args: argparse.Namespace, found: Comparison) -> None:
    pictures = []
    for index, output in enumerate(found.outputs):
        cut = slice_at(args, found.one, output)
        figure = plot_difference(found.one, found.other, index, cut, output)
        pictures.append((output.name, save(figure, folder, f"difference_{file_name(output.name)}")))
    page = render("rules/views/diff.html.j2", found=found, report=report(found), pictures=pictures)
    (folder / "index.html").write_text(page, encoding="utf-8")


def run(args: argparse.Namespace) -> int:
    one, other = read_pair(args)
    slice_of(args, one)  # refuses what does not fit before anything is compared
    grid = make_grid(one, other)
    found = Comparison(
        one,
        other,
        structural_differences(one, other),
        compare_outputs(one, other, grid, args.threshold),
        grid.points,
    )
    out = args.out or results_folder() / "rules/diff" / f"{args.a.stem}_{args.b.stem}"
    with output_files(out) as staging:
        write_files(staging, args, found)
        written = sorted(file.name for file in staging.iterdir())
    outputs = [shown(out / name) for name in written]
    if args.json:
        print(json.dumps({**json_object(found), "written": outputs}, indent=1))
    else:
        print(f"{report(found)}\n\nwritten  {', '.join(outputs)}")
    return 0 if found.is_same else EXIT_FAILED
