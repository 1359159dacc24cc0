"""`quiesce identify compare MODEL.toml NEW.csv`: a damper model against new data."""

import argparse
import html
import json
import math
from pathlib import Path
from typing import Any

from quiesce.atomic import output_files
from quiesce.damper.cli_help import fill
from quiesce.damper.compare import Comparison, compare
from quiesce.damper.data.options import add_data_options, records_of
from quiesce.damper.data.split import split_records
from quiesce.damper.file_force import simulator_of_file
from quiesce.damper.report.page import html_table, items
from quiesce.damper.report.plots import plot_errors, plot_loops, plot_residual, plot_time
from quiesce.damper.report.runs import runs_of, whiteness_of
from quiesce.damper.report.tables import Table, percent, plain, shortened, whiteness_text
from quiesce.errors import UsageError
from quiesce.hil_page import CSS, image
from quiesce.paths import shown
from quiesce.table import format_table

NAME = "compare"
HELP = "score a model file on new data"
EPILOG = """The model runs free over the new tests; nothing is fitted. With --train and --test only
the test part is scored. Hints say which one constant (sign, scale, offset, shift in time) would
reduce the error a lot; they are not applied.

examples:
  quiesce identify compare damper.toml new.csv
  quiesce identify compare damper.toml new.csv --force Load:kN --json
"""


def add_options(parser: argparse.ArgumentParser) -> None:
    fill(parser, EPILOG)
    parser.add_argument("model", type=Path, metavar="MODEL.toml", help="damper file")
    parser.add_argument("files", nargs="+", type=Path, metavar="NEW.csv", help="recordings")
    parser.add_argument("--out", type=Path, metavar="FOLDER", help="write a page with plots there")
    parser.add_argument("--json", action="store_true", help="print one JSON object")
    add_data_options(parser.add_argument_group("data"))


def run(args: argparse.Namespace) -> int:
    check_is_model(args.model)
    damper, simulate = simulator_of_file(args.model)
    data = records_of(args)
    train, test = split_records(data.records, data.split)
    found = compare(damper, runs_of(simulate, [], test or train))
    if args.out:
        write_page(args.out, args.model, found, data.notes)
    if args.json:
        print(json.dumps(numbers_of(found, data.notes), indent=1))
    else:
        print(text_of(args.model, found, data.notes))
        if args.out:
            print(f"\nwritten: {shown(args.out)}/compare.html")
    return 0


def check_is_model(file: Path) -> None:
    """The likeliest mistake is the order of the files."""
    if file.suffix.lower() == ".csv":
        raise UsageError(
            f"{shown(file)}: a damper file (.toml) comes first, then the data: "
            "quiesce identify compare MODEL.toml NEW.csv"
        )
    if not file.is_file():
        raise UsageError(f"{shown(file)}: no such file; name a damper file (TOML)")


def test_table(found: Comparison) -> Table:
    head = ["test", "command", "rows", "error %", "largest error N", "energy, model/measured"]
    rows = [
        [
            shortened(one.name),
            run.label,
            str(one.samples),
            percent(one.error),
            f"{one.largest_N:.4g}",
            f"{ratio:.3f}" if math.isfinite(ratio) else "-",
        ]
        for one, run, ratio in zip(
            found.score.segments, found.runs, found.energy_ratios, strict=True
        )
    ]
    return head, rows


def hint_lines(found: Comparison) -> list[str]:
    return [f"{one.text}; error {percent(one.error)} % then" for one in found.hints]


def text_of(file: Path, found: Comparison, notes: list[str]) -> str:
    parts = [
        f"{shown(file)}: {found.damper.name} ({found.damper.model})",
        *(f"- {note}" for note in notes),
        "",
        format_table(*test_table(found), left=(0,)),
        "",
        f"error of all rows  {percent(found.score.error)} %  (||F - F_model|| / ||F||, free)",
        f"mean of the tests  {percent(found.score.mean_error)} %",
        whiteness_text(whiteness_of(found.runs)),
    ]
    for title, lines in (("Warnings", found.warnings), ("Hints, not applied", hint_lines(found))):
        if lines:
            parts += ["", f"{title}:", *(f"- {line}" for line in lines)]
    return "\n".join(parts)


def numbers_of(found: Comparison, notes: list[str]) -> dict[str, Any]:
    return plain(
        {
            "model": found.damper.model,
            "name": found.damper.name,
            "error": found.score.error,
            "mean_error": found.score.mean_error,
            "tests": [
                {
                    "test": one.name,
                    "command": one.level,
                    "rows": one.samples,
                    "error": one.error,
                    "largest_error_N": one.largest_N,
                    "energy_ratio": ratio,
                }
                for one, ratio in zip(found.score.segments, found.energy_ratios, strict=True)
            ],
            "hints": [vars(one) for one in found.hints],
            "warnings": found.warnings,
            "notes": notes,
        }
    )


def write_page(folder: Path, file: Path, found: Comparison, notes: list[str]) -> None:
    """compare.html in `folder`."""
    drawn = "<p><b>The model diverges on this data: no plots.</b></p>"
    if all(run.is_finite for run in found.runs):
        drawn = "".join(
            [
                image(plot_time(found.runs), "force against time"),
                image(plot_loops(found.runs), "force against displacement and velocity"),
                image(plot_residual(found.runs), "residual"),
                image(plot_errors([(found.damper.name, found.runs)]), "error by command"),
            ]
        )
    title = html.escape(found.damper.name)
    page = f"""<!doctype html>
<html lang="en"><head><meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>Quiesce: {title} against new data</title><style>{CSS}</style></head><body><main>
<h1>{title} against new data</h1>
<p class="lead">{html.escape(found.damper.model)} from <code>{html.escape(shown(file))}</code>,
running free. Error of all rows {percent(found.score.error)} %.</p>
{html_table(test_table(found), (0,))}
{items(found.warnings)}{items(hint_lines(found))}
{drawn}
<h2>Data</h2>{items(notes)}
</main></body></html>
"""
    with output_files(folder) as staging:
        (staging / "compare.html").write_text(page, encoding="utf-8")
