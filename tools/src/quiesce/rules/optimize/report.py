"""The files of a search's report: Markdown, one self-contained HTML page, JSON, rule files."""

import json
from pathlib import Path

from quiesce.report.page import render
from quiesce.rules.formats.files import write_text
from quiesce.rules.optimize.plots import (
    plot_convergence,
    plot_front,
    plot_places,
    plot_surfaces,
)
from quiesce.rules.optimize.result import Found, result_json, text_sections

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


def page(found: Found) -> str:
    return render(
        "rules/optimize/report.html.j2",
        found=found,
        lead=LEAD,
        places=plot_places(found),
        surfaces=plot_surfaces(found),
        convergence=plot_convergence(found),
        front=plot_front(found),
        texts=text_sections(found),
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
