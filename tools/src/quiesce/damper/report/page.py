"""The report of `quiesce identify`: one HTML page that needs nothing beside it, and report.json."""

import html
import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from quiesce.base.atomic import output_files
from quiesce.base.errors import UsageError
from quiesce.damper.data.split import Segment
from quiesce.damper.fitted import Fitted
from quiesce.damper.ranking import ranked
from quiesce.damper.report.plots import (
    plot_errors,
    plot_loops,
    plot_ranking,
    plot_residual,
    plot_time,
)
from quiesce.damper.report.runs import Run, runs_of, shown_part, whiteness_of
from quiesce.damper.report.tables import (
    data_lines,
    json_report,
    parameter_table,
    percent,
    ranking_table,
    segment_table,
    whiteness_text,
    winner_table,
    winners,
)
from quiesce.damper.simulate import simulator
from quiesce.report.html import card, cards, document, html_table, image, items, section

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
    shown = {id(one): one for one in winners(fitted).values()}.values()
    runs = {id(one): runs_of(simulator(one.damper), train, test) for one in shown}
    white = whiteness_of(shown_part(runs[id(ranked(fitted)[0])]))
    numbers = json_report(fitted, train, test, notes, context, white)
    sections = [model_section(one, runs[id(one)]) for one in shown]
    errors = [(one.name, runs[id(one)]) for one in shown if all(r.is_finite for r in runs[id(one)])]
    comparison = plot_errors(errors) if errors else ""
    page = make_page(fitted, data_lines(train, test), notes, context, comparison, sections)
    with output_files(folder) as staging:
        (staging / PAGE).write_text(page, encoding="utf-8")
        (staging / NUMBERS).write_text(json.dumps(numbers, indent=1) + "\n", encoding="utf-8")


def winner_cards(fitted: Sequence[Fitted]) -> str:
    found = [
        card(f"{percent(one.test.error if one.test else one.validation_error)} %",
             f"{'held-out' if one.test else 'validation'} error, {what}: {one.name}")
        for what, one in winners(fitted).items()
    ]  # fmt: skip
    return cards(found)


def model_section(one: Fitted, runs: Sequence[Run]) -> str:
    """Everything about one of the winners."""
    parts = [
        f"<h2>{html.escape(one.name)}: {html.escape(one.title)}</h2>",
        f"<p>{html.escape(one.kind)}, passive: {html.escape(one.passivity.text)}, "
        f"{one.parameter_count} numbers fitted in {one.seconds:.1f} s"
        f"{'' if one.is_complete else ', cut short'}.</p>",
        items(one.notes),
    ]
    if one.intervals:
        parts += [html_table(parameter_table(one), (0, 3, 4)), INTERVALS]
    if not all(run.is_finite for run in runs):
        return "".join([*parts, "<p><b>The model diverges on this data: no plots.</b></p>"])
    white = whiteness_text(whiteness_of(shown_part(runs)))
    parts += [
        image(plot_time(runs), f"{one.name}: force against time"),
        image(plot_loops(runs), f"{one.name}: force against displacement and velocity"),
        image(plot_residual(runs), f"{one.name}: residual"),
        f"<p>{html.escape(white[0].upper() + white[1:])}.</p>",
        "<details><summary>Error of every test</summary>",
        html_table(segment_table(one), (0, 1)),
        "</details>",
    ]
    return "".join(parts)


INTERVALS = """<p>Intervals hold if the model is right; they are widened by the correlation of the
residual. <b>At its bound</b>: the data push the parameter further than it may go. A parameter that
follows the current is given by its values at the currents behind the @.</p>"""

RULES = """<p>Errors are ‖F − F<sub>model</sub>‖ / ‖F‖ with the force as it is in the file, the
model running free: it sees motion and command, never a measured force. The order is that of the
validation error, found inside the training part by models that had not seen those rows; errors
within 2 % of each other are a tie, which the smaller model wins. Held-out rows played no part in
it.</p>"""


def make_page(
    fitted: Sequence[Fitted],
    data: Sequence[str],
    notes: Sequence[str],
    context: dict[str, Any],
    comparison: str,
    sections: Sequence[str],
) -> str:
    title = html.escape(str(context.get("title", "damper")))
    command = str(context.get("command", ""))
    files = [str(one) for one in context.get("files", [])]
    return document(
        f"{context.get('title', 'damper')} identified",
        f"""<h1>Damper models for {title}</h1>
{winner_cards(fitted)}
<h2>Ranking</h2>{RULES}
{html_table(ranking_table(fitted), (1, 2, 7, 9))}
{html_table(winner_table(fitted), (0, 1))}
{section("Error against size", "", image(plot_ranking(fitted), "error against numbers fitted"))}
{section("Error by command", "Of the best of each kind.", image(comparison, "error by command"))}
<h2>Data</h2>{items([*data, *notes])}
{"".join(sections)}
{f"<h2>Files</h2>{items(files)}" if files else ""}
{f"<h2>Run it again</h2><pre>{html.escape(command)}</pre>" if command else ""}""",
    )
