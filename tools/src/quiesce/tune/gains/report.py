"""What a tuning found: as text, as data, as files."""

import json
import shlex
from typing import Any

import tomli_w

from quiesce.base.atomic import output_files
from quiesce.base.paths import shown, typed
from quiesce.base.table import format_table
from quiesce.table.file import SUFFIX
from quiesce.tune.gains.aim import Runs
from quiesce.tune.gains.page import page
from quiesce.tune.gains.run import Tuned

SCHEMA = "quiesce-tuned-law"
VERSION = 1
Rows = tuple[list[str], list[list[str]]]  # head, body


def value_rows(tuned: Tuned) -> Rows:
    """A row a setting."""
    best, start = tuned.best.values, tuned.start.values
    body = [
        [
            one.name,
            f"{start[one.name]:g}",
            f"{best[one.name]:g}",
            f"{one.low:.4g} .. {one.high:.4g}{', log' if one.is_log else ''}"
            if one.is_searched
            else "",
        ]
        for one in tuned.tunable.space.known
    ]
    return ["setting", "start", "tuned", "searched"], body


def record_rows(tuned: Tuned) -> Rows:
    """A row a record, and what is minimised; the best constant is the best for all of them."""
    figure = tuned.order.aim.figure
    columns = {
        "no current": tuned.constants[0],
        "all current": tuned.constants[-1],
        "best constant": min(tuned.constants, key=tuned.cost),
        "start": tuned.start.runs,
        "tuned": tuned.best.runs,
    }
    body = [
        [one.name, *(f"{runs[one.name][figure]:.4g}" for runs in columns.values())]
        for one in tuned.order.records
    ]
    body.append(["all", *(f"{tuned.cost(runs):.4g}" for runs in columns.values())])
    return [figure, *columns], body


def text(tuned: Tuned) -> str:
    order = tuned.order
    refused = sum(not one.runs for one in tuned.trials)
    lines = [
        f"{order.recipe.name} on {tuned.tunable.rig.name}: {len(tuned.trials)} trials"
        + (f", {refused} of them refused" if refused else "")
        + f"; all: {order.aim.text}",
        "",
        format_table(*value_rows(tuned), (0, 3)),
        "",
        format_table(*record_rows(tuned)),
        "",
        f"written    {shown(order.folder)}: {', '.join(names(tuned))}",
        f"run it     {compare_command(tuned)}",
    ]
    if tuned.is_interrupted:
        lines.append("interrupted; the same command goes on with the trials that are finished")
    return "\n".join(lines)


def names(tuned: Tuned) -> list[str]:
    stem = tuned.order.recipe.name
    return [f"{stem}.toml", f"{stem}{SUFFIX}", "tune.html", "tune.json"]


def compare_command(tuned: Tuned) -> str:
    """Runs it beside constants."""
    order, best = tuned.order, tuned.best.values
    words = {"table": shown(order.folder / f"{order.recipe.name}{SUFFIX}")}
    words |= {"map": shown(order.map_file)} if order.map_file else {}
    words |= {name: str(value) for name, value in tuned.tunable.parameters(best).items()}
    law = tuned.tunable.made(best).table.law
    told = ",".join(f"{key}={value}" for key, value in {**words, "as": "tuned"}.items())
    return typed(shlex.join(["quiesce", "compare", *order.shared, "--law", f"{law}:{told}"]))


def data_of(tuned: Tuned) -> dict[str, Any]:
    order = tuned.order

    def runs_data(runs: Runs) -> dict[str, Any]:
        return {"cost": tuned.cost(runs), "runs": runs}

    return {
        "recipe": order.recipe.name,
        "board": tuned.tunable.rig.name,
        "command": order.command,
        "compare": compare_command(tuned),
        "aim": order.aim.text,
        "trials": len(tuned.trials),
        "interrupted": tuned.is_interrupted,
        "settings": tuned.tunable.space.settings(tuned.best.values),
        "parameters": tuned.tunable.parameters(tuned.best.values),
        "start": {"values": tuned.start.values, **runs_data(tuned.start.runs)},
        "tuned": {"values": tuned.best.values, **runs_data(tuned.best.runs)},
        "no_current": runs_data(tuned.constants[0]),
        "all_current": runs_data(tuned.constants[-1]),
        "best_constant": runs_data(min(tuned.constants, key=tuned.cost)),
        "files": names(tuned),
    }


def settings_toml(tuned: Tuned) -> str:
    data = data_of(tuned)
    head = {"schema": SCHEMA, "version": VERSION}
    head |= {key: data[key] for key in ("recipe", "board", "command", "compare")}
    reached = {"aim": data["aim"], "trials": data["trials"]}
    reached |= {key: data[key]["cost"] for key in ("start", "tuned", "best_constant", "no_current")}
    return tomli_w.dumps(
        {**head, "settings": data["settings"], "parameters": data["parameters"], "reached": reached}
    )


def write(tuned: Tuned) -> None:
    """All of `names`, or none."""
    toml, table, html, json_file = names(tuned)
    with output_files(tuned.order.folder) as folder:
        (folder / toml).write_text(settings_toml(tuned), encoding="utf-8")
        (folder / table).write_bytes(tuned.tunable.file(tuned.best.values))
        made = page(tuned, value_rows(tuned), record_rows(tuned), compare_command(tuned))
        (folder / html).write_text(made, encoding="utf-8")
        (folder / json_file).write_text(json.dumps(data_of(tuned), indent=1) + "\n", "utf-8")
