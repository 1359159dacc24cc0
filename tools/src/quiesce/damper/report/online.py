"""What on-line adaptation came to, as text, numbers, plots and page."""

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from quiesce.base.atomic import output_files
from quiesce.base.table import format_table
from quiesce.damper.learned.self_tuning import SelfTuning
from quiesce.damper.model_file import DamperModel
from quiesce.damper.online import ADAPTIVE, Followed
from quiesce.damper.plain import plain
from quiesce.damper.report.tables import Table
from quiesce.report.page import render
from quiesce.report.plot_style import COLORS, pyplot, svg_of

PAGE = "online.html"
MODEL = "adapted.toml"
WINDOW_s = 0.5
# Rows that one curve shows.
MOST_ROWS = 3000
_COLOURS = ("current", "constant_best", "phase", "fuzzy_selftune_printed", "phase_displacement")
_SHOWN_s = 1.0  # before and after the change, of the force
_MOST_pct = 150.0  # of the axis of errors


def percent(value: float) -> str:
    return f"{value:.2f}" if math.isfinite(value) else "diverges"


def kind_of(found: Followed, name: str) -> str:
    if name == ADAPTIVE:
        return "adapts, is told every force"
    return "frozen at the change" if name in found.frozen_N else "only looked at"


def error_table(found: Followed) -> Table:
    parts = list(found.parts())
    rows = [
        [name, kind_of(found, name), *(percent(errors[part]) for part in parts)]
        for name, errors in found.errors_pct().items()
    ]
    settle = f"{found.settle_s:g} s"
    return ["model", "", "before %", f"first {settle} %", f"from {settle} on %"], rows


def summary(found: Followed) -> str:
    best = found.best_frozen()
    ratio = found.over_best_frozen()
    return (
        f"from {found.settle_s:g} s after the change on the adaptive model's error is {ratio:.2f} "
        f"of that of the best frozen one, {best}"
    )


def stream_lines(found: Followed) -> list[str]:
    stream = found.stream
    change_s = stream.change / stream.rate_Hz
    return [
        f"{len(stream.records)} test(s) in a row, {len(stream)} rows, "
        f"{len(stream) / stream.rate_Hz:.4g} s at {stream.rate_Hz:g} Hz",
        f"change at {change_s:.4g} s; frozen models are fitted to what precedes it",
        "error before: over the second half of that",
    ]


def text_of(found: Followed, notes: Sequence[str]) -> str:
    parts = [
        *(f"- {note}" for note in [*notes, *found.notes]),
        *stream_lines(found),
        "",
        "errors are ||F - F_model|| / ||F||; frozen models run free",
        format_table(*error_table(found), left=(0, 1)),
        "",
        summary(found),
    ]
    return "\n".join(parts)


def numbers_of(found: Followed, notes: Sequence[str]) -> dict[str, Any]:
    stream = found.stream
    return plain(
        {
            "rate_Hz": stream.rate_Hz,
            "rows": len(stream),
            "change_s": stream.change / stream.rate_Hz,
            "settle_s": found.settle_s,
            "models": {
                name: {"kind": kind_of(found, name), "error_pct": errors}
                for name, errors in found.errors_pct().items()
            },
            "best_frozen": found.best_frozen(),
            "online_over_best_frozen": found.over_best_frozen(),
            "window_s": WINDOW_s,
            "error_over_time": over_time(found),
            "parameters": {"start": found.start.parameters(), "end": found.end.parameters()},
            "notes": [*notes, *found.notes],
        }
    )


def over_time(found: Followed) -> dict[str, list[float]]:
    """Times in s and each model's error in % over the window before, twenty a window."""
    step = max(1, round(WINDOW_s * found.stream.rate_Hz / 20.0))
    rows = slice(step - 1, None, step)
    curves = {
        name: found.error_over_time_pct(force_N, WINDOW_s)[rows].tolist()
        for name, force_N in found.models_N().items()
    }
    return {"time_s": found.stream.time_s[rows].tolist(), **curves}


# Plots


def plot_errors(found: Followed) -> str:
    curves = over_time(found)
    time_s = curves.pop("time_s")
    change_s = found.stream.change / found.stream.rate_Hz
    figure, axis = pyplot().subplots(figsize=(9.5, 4.0))
    axis.axvspan(change_s, change_s + found.settle_s, color=COLORS["shade"], label="settling")
    for name, errors in curves.items():
        is_other = name in found.beside_N
        colour = _COLOURS[list(found.frozen_N).index(name) % len(_COLOURS)] if (
            name in found.frozen_N
        ) else ("muted" if is_other else "main")  # fmt: skip
        axis.plot(
            time_s, np.minimum(errors, _MOST_pct), color=COLORS[colour], label=name,
            lw=1.8 if name == ADAPTIVE else 1.0, ls=":" if is_other else "-",
        )  # fmt: skip
    axis.set(xlabel="time (s)", ylabel=f"error over {WINDOW_s:g} s (% of the force)")
    axis.set_ylim(bottom=0.0)
    axis.set_title("error before, during and after the change")
    axis.legend(ncols=3)
    return svg_of(figure)


def plot_force(found: Followed) -> str:
    """A second on each side of the change."""
    stream = found.stream
    half = round(_SHOWN_s * stream.rate_Hz)
    rows = slice(max(0, stream.change - half), stream.change + half)
    step = max(1, -(-2 * half // MOST_ROWS))
    time_s, force_N = stream.time_s[rows][::step], stream.column("force_N")[rows][::step]
    best = found.best_frozen()
    figure, axis = pyplot().subplots(figsize=(9.5, 3.2))
    axis.plot(time_s, force_N, color=COLORS["muted"], lw=2.0, label="measured")
    axis.plot(time_s, found.adaptive_N[rows][::step], color=COLORS["main"], lw=0.9, label=ADAPTIVE)
    axis.plot(time_s, found.frozen_N[best][rows][::step], color=COLORS["current"], lw=0.9,
              label=best)  # fmt: skip
    axis.axvline(stream.change / stream.rate_Hz, color=COLORS["bound"], lw=0.6)
    axis.set(xlabel="time (s)", ylabel="force (N)")
    axis.legend(ncols=3)
    return svg_of(figure)


def plot_memberships(found: Followed) -> str:
    """Of displacement and velocity, before the first sample and after the last."""
    figure, axes = pyplot().subplots(2, 2, figsize=(9.5, 3.6), sharex=True, sharey=True)
    grid = np.linspace(-1.0, 1.0, 401)
    models: tuple[tuple[str, SelfTuning], ...] = (("start", found.start), ("end", found.end))
    for row, (when, model) in zip(axes, models, strict=True):
        inputs = (("displacement", model.disp), ("velocity", model.velocity))
        for axis, (name, triangles) in zip(row, inputs, strict=True):
            axis.plot(grid, np.array([triangles.grades(at) for at in grid]), lw=1.0)
            axis.set_title(f"{name}, {when}")
    return svg_of(figure)


def write_page(
    folder: Path, title: str, command: str, found: Followed, adapted: DamperModel,
    notes: Sequence[str],
) -> None:  # fmt: skip
    """online.html and, as it stands after the last row, the adaptive model."""
    best = found.best_frozen()
    page = render(
        "damper/report/online.html.j2",
        name=title,
        summary=summary(found).capitalize(),
        adaptive=percent(found.error_pct(found.adaptive_N, "after")),
        frozen=percent(found.error_pct(found.frozen_N[best], "after")),
        best=best,
        ratio=found.over_best_frozen(),
        errors=error_table(found),
        over_time=plot_errors(found),
        force=plot_force(found),
        memberships=plot_memberships(found),
        data=[*stream_lines(found), *notes, *found.notes],
        command=command,
    )
    with output_files(folder) as staging:
        (staging / PAGE).write_text(page, encoding="utf-8")
        (staging / MODEL).write_text(adapted.to_toml(), encoding="utf-8")
