"""What a comparison with new data says, as text, numbers and page."""

import math
from pathlib import Path
from typing import Any

from quiesce.base.atomic import output_files
from quiesce.base.paths import shown
from quiesce.base.table import format_table
from quiesce.damper.compare import Comparison
from quiesce.damper.plain import plain
from quiesce.damper.report.plots import plot_errors, plot_loops, plot_residual, plot_time
from quiesce.damper.report.runs import shortened, whiteness_of
from quiesce.damper.report.tables import Table, percent, whiteness_text
from quiesce.report.page import render


def score_table(found: Comparison) -> Table:
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
        format_table(*score_table(found), left=(0,)),
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
    pictures = {}
    if all(run.is_finite for run in found.runs):
        pictures = {
            "force against time": plot_time(found.runs),
            "force against displacement and velocity": plot_loops(found.runs),
            "residual": plot_residual(found.runs),
            "error by command": plot_errors([(found.damper.name, found.runs)]),
        }
    page = render(
        "damper/report/comparison.html.j2",
        found=found,
        file=shown(file),
        error=percent(found.score.error),
        scores=score_table(found),
        hints=hint_lines(found),
        pictures=pictures,
        notes=notes,
    )
    with output_files(folder) as staging:
        (staging / "compare.html").write_text(page, encoding="utf-8")
