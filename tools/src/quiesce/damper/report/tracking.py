"""What a comparison of inverses says, as text, numbers and page."""

from collections.abc import Sequence
from typing import Any

from quiesce.base.table import format_table
from quiesce.damper.inverses.banked import BankInverse
from quiesce.damper.inverses.made import Made
from quiesce.damper.inverses.methods import METHODS
from quiesce.damper.inverses.tracking import CONSTANT, IDEAL, Compared, Run, error_pct
from quiesce.damper.plain import plain
from quiesce.report.page import render
from quiesce.report.plot_style import COLORS, pyplot, svg_of

PAGE = "inverse.html"
_SHOWN_s = 2.0
Table = tuple[list[str], list[list[str]]]


def task_names(found: Compared) -> list[str]:
    return [one.task.demand.name for one in found.runs[IDEAL]]


def error_table(found: Compared) -> Table:
    """Rows by error, peers among them."""
    errors = found.errors_pct()
    rows = [
        [name, f"{errors[name]:.1f}", *(f"{error_pct([run]):.1f}" for run in found.runs[name])]
        for name in sorted(errors, key=lambda one: errors[one])
    ]
    return ["inverse", "error, %", *task_names(found)], rows


def method_table(inverses: Sequence[Made]) -> Table:
    rows = [
        [
            one.name,
            METHODS[one.method].TITLE,
            f"{one.inverse.max_current_A:.4g}",
            f"{one.seconds:.1f}" if one.seconds else "read",
            one.tracker,
        ]
        for one in inverses
    ]
    return ["inverse", "what it is", "up to A", "made in s", "controller"], rows


def peer_lines(found: Compared) -> list[str]:
    return [
        f"{CONSTANT}: {found.constant_A:.3g} A throughout, the best one current for these tasks",
        f"{IDEAL}: the very damper's copies at constant currents, not looking ahead to the coil",
        "error: force against the nearest that the damper could give, of its size; from 0.5 s on",
    ]


def notes_of(inverses: Sequence[Made]) -> list[str]:
    return [
        line
        for one in inverses
        if isinstance(one.inverse, BankInverse)
        for line in one.inverse.notes()
    ]


def text_of(inverses: Sequence[Made], found: Compared | None) -> str:
    parts = [format_table(*method_table(inverses), left=(0, 1, 4))]
    if notes := notes_of(inverses):
        parts += ["", *notes]
    if found is not None:
        parts += ["", format_table(*error_table(found), left=(0,)), "", *peer_lines(found)]
    return "\n".join(parts)


def numbers_of(inverses: Sequence[Made], found: Compared | None) -> dict[str, Any]:
    numbers: dict[str, Any] = {
        "inverses": [
            {
                "name": one.name,
                "method": one.method,
                "max_current_A": one.inverse.max_current_A,
                "made_in_s": one.seconds,
                "controller": one.tracker,
                "has_map": one.own_map is not None or one.method == "map",
                "fit_error_pct": list(getattr(one.inverse, "fit_error_pct", ())),
            }
            for one in inverses
        ]
    }
    if found is not None:
        numbers["tracking_error_pct"] = found.errors_pct()
        numbers["by_task_pct"] = {
            name: {run.task.demand.name: error_pct([run]) for run in runs}
            for name, runs in found.runs.items()
        }
        numbers["constant_A"] = found.constant_A
    return plain(numbers)


def plot_task(found: Compared, index: int, names: Sequence[str]) -> str:
    """Forces and currents over the last seconds of one task."""
    plt = pyplot()
    figure, axes = plt.subplots(2, 1, figsize=(10, 5), sharex=True)
    task = found.runs[IDEAL][index].task
    time_s = task.demand.time_s
    rows = slice(max(0, len(time_s) - int(_SHOWN_s * task.demand.rate_Hz)), len(time_s))
    axes[0].plot(time_s[rows], task.target_N[rows], color=COLORS["bound"], lw=2.2, label="target")
    shades = plt.get_cmap("viridis")([k / max(1, len(names) - 1) for k in range(len(names))])
    for name, shade in zip(names, shades, strict=True):
        run: Run = found.runs[name][index]
        axes[0].plot(time_s[rows], run.force_N[rows], color=shade, lw=0.9, label=name)
        axes[1].plot(time_s[rows], run.current_A[rows], color=shade, lw=0.9)
    axes[0].set(ylabel="force (N)", title=task.demand.name)
    axes[1].set(ylabel="command (A)", xlabel="time (s)")
    axes[0].legend(ncols=4)
    return svg_of(figure)


def page_of(
    title: str, inverses: Sequence[Made], found: Compared | None, files: Sequence[str], command: str
) -> str:
    names = [one.name for one in inverses]
    tasks = task_names(found) if found else []
    errors = found.errors_pct() if found else {}
    return render(
        "damper/report/tracking.html.j2",
        name=title,
        cards=[(f"{errors[one]:.1f} %", one) for one in [*names, CONSTANT, IDEAL] if errors],
        methods=method_table(inverses),
        notes=notes_of(inverses),
        pictures={task: plot_task(found, k, [*names, IDEAL]) for k, task in enumerate(tasks)},
        peers=found and peer_lines(found),
        errors=found and error_table(found),
        files=files,
        command=command,
    )
