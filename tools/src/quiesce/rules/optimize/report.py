"""The files of a search's report: Markdown, one self-contained HTML page, JSON, rule files."""

import json
from pathlib import Path

from quiesce.report.html import card, cards, preformatted
from quiesce.rules.formats.files import write_text
from quiesce.rules.optimize.plots import (
    plot_convergence,
    plot_front,
    plot_places,
    plot_surfaces,
)
from quiesce.rules.optimize.result import Found, result_json, text_sections
from quiesce.rules.views.page import make_page, picture

LEAD = (
    "Rule bases tried in closed loop: the controller's firmware against the simulated structure. A "
    "table of rules that has settled gives one current in a steady state, so the best constant "
    "current stands beside it as what such a table can reach."
)


def headline(found: Found) -> str:
    cost = found.objective.cost
    return (
        f"cost {cost(found.start_outcome):.3f} -> {cost(found.best_outcome):.3f}, best constant "
        f"currents {cost(found.constant_outcome):.3f} (lower is better; "
        f"{found.evaluations} rule bases tried)"
    )


def markdown(found: Found) -> str:
    parts = [f"# Rule search: {found.best.name}", LEAD, f"**{headline(found)}**"]
    for title, text in text_sections(found):
        parts.append(f"## {title}\n\n```text\n{text}\n```")
    parts.append(f"## Run it again\n\n```sh\n{found.command}\n```")
    return "\n\n".join(parts) + "\n"


def cost_cards(found: Found) -> str:
    cost = found.objective.cost
    shown = (
        (f"{cost(found.start_outcome):.2f}", "cost of the start"),
        (f"{cost(found.best_outcome):.2f}", "cost of the rule base found"),
        (f"{cost(found.constant_outcome):.2f}", "cost of the best constant currents"),
        (f"{found.evaluations:,}", "rule bases tried"),
    )
    return cards([card(*pair) for pair in shown])


def page(found: Found) -> str:
    pictures = (
        ("Reductions by frequency", plot_places(found)),
        ("Rule surface, before and after", plot_surfaces(found)),
        ("Convergence", plot_convergence(found)),
        ("Pareto front", plot_front(found)),
    )
    drawn = [picture(title, "", svg) for title, svg in pictures]
    tables = [preformatted(title, text) for title, text in text_sections(found)]
    again = preformatted("Run it again", found.command)
    return make_page(
        f"Rule search: {found.best.name}", LEAD, [cost_cards(found), *drawn, *tables, again]
    )


def write_report(found: Found, folder: Path) -> None:
    """best.fcl, front_NN.fcl, report.md, report.html, result.json."""
    texts = {
        "best.fcl": write_text(found.best, "fcl"),
        "report.md": markdown(found),
        "report.html": page(found),
        "result.json": json.dumps(result_json(found), indent=1) + "\n",
    }
    for i, point in enumerate(found.front):
        texts[f"front_{i + 1:02}.fcl"] = write_text(point.base, "fcl")
    for name, text in texts.items():
        (folder / name).write_text(text, encoding="utf-8")
