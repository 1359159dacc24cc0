"""The report of `quiesce identify`: one HTML page that needs nothing beside it, and report.json."""

import json
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import Any

from quiesce.base.atomic import output_files
from quiesce.base.errors import UsageError
from quiesce.damper.data.split import Segment
from quiesce.damper.fitted import Fitted
from quiesce.damper.report.plots import (
    plot_errors,
    plot_loops,
    plot_ranking,
    plot_residual,
    plot_time,
    plot_where,
)
from quiesce.damper.report.runs import Run, runs_of, shown_part, whiteness_of
from quiesce.damper.report.tables import (
    Table,
    band_lines,
    data_lines,
    json_report,
    parameter_table,
    percent,
    ranking_table,
    segment_table,
    validation_lines,
    validation_table,
    whiteness_text,
    winner_table,
    winners,
)
from quiesce.damper.report.where import sentences
from quiesce.damper.simulate import simulator
from quiesce.report.page import render

PAGE = "report.html"
NUMBERS = "report.json"


def write_report(
    folder: Path,
    fitted: Sequence[Fitted],
    train: Sequence[Segment],
    test: Sequence[Segment],
    notes: Sequence[str],
    context: dict[str, Any],
) -> None:
    """Writes report.html and report.json into `folder`, both or neither.

    context: whatever else is to be kept; "title", "command" (how to run it again) and "files" (what
    was written beside it) are shown on the page. UsageError where nothing was fitted.
    """
    if not fitted:
        raise UsageError("no model was fitted, so there is nothing to report")
    shown = list({id(one): one for one in winners(fitted).values()}.values())
    runs = [runs_of(simulator(one.damper), train, test) for one in shown]
    white = whiteness_of(shown_part(runs[0]))  # the best comes first
    where = sentences(shown_part(runs[0])) if is_finite(runs[0]) else []
    numbers = json_report(fitted, train, test, notes, context, white, where)
    finite = [(one.name, r) for one, r in zip(shown, runs, strict=True) if is_finite(r)]
    page = render(
        "damper/report/page.html.j2",
        title=context.get("title", "damper"),
        command=context.get("command"),
        files=context.get("files"),
        winners=winners(fitted),
        percent=percent,
        ranking=ranking_table(fitted),
        validation=validation_table(fitted),
        stands=[*validation_lines(fitted), *band_lines(fitted)],
        best=winner_table(fitted),
        sizes=plot_ranking(fitted),
        by_command=plot_errors(finite) if finite else "",
        data=[*data_lines(train, test), *notes],
        models=[model_part(*pair) for pair in zip(shown, runs, strict=True)],
    )
    with output_files(folder) as staging:
        (staging / PAGE).write_text(page, encoding="utf-8")
        (staging / NUMBERS).write_text(json.dumps(numbers, indent=1) + "\n", encoding="utf-8")


def is_finite(runs: Sequence[Run]) -> bool:
    return all(run.is_finite for run in runs)


def model_part(
    one: Fitted, runs: Sequence[Run]
) -> tuple[Fitted, Table, Table, str, list[str], dict[str, str]]:
    """One of the winners, its parameters, its tests, how white its residual is, where its error is
    made, its pictures by name: none where it diverges."""
    pictures = {
        "force against time": partial(plot_time, band=one.band),
        "force against displacement and velocity": plot_loops,
        "residual": plot_residual,
        "where the error is made": plot_where,
    }
    drawn = {name: plot(runs) for name, plot in pictures.items() if is_finite(runs)}
    white = whiteness_text(whiteness_of(shown_part(runs))) if drawn else ""
    where = sentences(shown_part(runs)) if drawn else []
    return one, parameter_table(one), segment_table(one), white, where, drawn
