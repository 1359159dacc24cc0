"""Measured against modelled force, the residual, and the ranking."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from quiesce.damper.band import Band, levels_along
from quiesce.damper.fit.intervals import autocorrelation
from quiesce.damper.fitted import Fitted
from quiesce.damper.ranking import ranked
from quiesce.damper.report.runs import Run, command_parts, one_a_level, shown_part
from quiesce.damper.report.where import course_of, places_of
from quiesce.report.plot_style import COLORS, pyplot, svg_of

# Rows that one curve shows: more hide each other and make files large.
MOST_ROWS = 3000
# Of the time plots: periods of the motion.
PERIODS = 4.0
# Tests whose error is shown along time, and their colours.
_COURSES = 4
_SHADES = ("main", "current", "constant_best", "fuzzy_selftune_printed")
_MARKERS = {"parametric": "o", "black box": "s"}


def colours_of(labels: Sequence[str]) -> dict[str, Any]:
    """One colour a command, from dark to light."""
    unique = list(dict.fromkeys(labels))
    shades = pyplot().get_cmap("viridis")(np.linspace(0.0, 0.85, max(1, len(unique))))
    return dict(zip(unique, shades, strict=True))


def usual_Hz(run: Run) -> float:
    """Frequency of the motion, from the crossings of its mean."""
    disp_m = run.segment.record.disp_m[run.segment.rows]
    centred = disp_m - disp_m.mean()
    crossings = np.count_nonzero(centred[:-1] * centred[1:] < 0.0)
    return max(crossings, 1) / 2.0 / max(len(disp_m) / run.rate_Hz, 1e-9)


def window(run: Run, periods: float = PERIODS) -> slice:
    """The most forceful stretch of a few periods."""
    length = int(np.clip(periods / usual_Hz(run) * run.rate_Hz, 20, MOST_ROWS))
    if length >= len(run.model_N):
        return slice(None)
    energy = np.concatenate([[0.0], np.cumsum(run.measured_N**2)])
    first = int(np.argmax(energy[length:] - energy[:-length]))
    return slice(first, first + length)


def plot_time(runs: Sequence[Run], band: Band | None = None) -> str:
    """A few periods of one test a command: force, residual, and the band for new rows."""
    plt = pyplot()
    found = one_a_level(shown_part(runs), most=4)
    figure, axes = plt.subplots(len(found), 1, figsize=(9.5, 2.2 * len(found)), squeeze=False)
    for axis, run in zip(axes[:, 0], found, strict=True):
        part = window(run)
        time_s = run.time_s[part]
        if band is not None and np.isfinite(band.part):
            half_N = band.half_width_N(levels_along(run.segment, run.model_N))[part]
            model_N = run.model_N[part]
            shade = {"color": COLORS["shade"], "lw": 0.0, "label": "95 % of the rows left out"}
            axis.fill_between(time_s, model_N - half_N, model_N + half_N, **shade)
        axis.plot(time_s, run.measured_N[part], color=COLORS["muted"], lw=2.0, label="measured")
        axis.plot(time_s, run.model_N[part], color=COLORS["main"], lw=0.9, label="model")
        axis.plot(time_s, run.residual_N[part], color=COLORS["current"], lw=0.6, label="residual")
        axis.set_ylabel("force (N)")
        part_name = "held out" if run.is_test else "fitted"
        axis.set_title(f"{run.label}, {part_name}: error {100.0 * run.error:.2f} %")
    axes[0, 0].legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), borderaxespad=0.1, ncols=4)
    axes[-1, 0].set_xlabel("time (s)")
    return svg_of(figure)


def plot_loops(runs: Sequence[Run]) -> str:
    """Force over displacement and over velocity: dots measured, line model."""
    plt = pyplot()
    parts = [
        (run, label, shown_rows(run, rows))
        for run in one_a_level(shown_part(runs))
        for label, rows in command_parts(run)
    ]
    colours = colours_of([label for _, label, _ in parts])
    figure, axes = plt.subplots(1, 2, figsize=(9.5, 4.4), sharey=True)
    for run, label, rows in parts:
        record = run.segment.record.rows(run.segment.first, run.segment.end)
        style = {"color": colours[label], "rasterized": True}
        # Gaps where the command is another one.
        model_N = np.where(rows, run.model_N, np.nan)
        part = slice(int(np.argmax(rows)), len(rows) - int(np.argmax(rows[::-1])))
        for axis, across in zip(axes, (1e3 * record.disp_m, record.velocity_m_s), strict=True):
            axis.plot(across[rows], run.measured_N[rows], ".", ms=2.0, alpha=0.4, **style)
            axis.plot(across[part], model_N[part], lw=1.1, label=label, **style)
    axes[0].set_xlabel("displacement (mm)")
    axes[0].set_ylabel("force (N)")
    axes[1].set_xlabel("velocity (m/s)")
    axes[1].legend(title="dots measured, line model")
    return svg_of(figure)


def shown_rows(run: Run, rows: np.ndarray) -> np.ndarray:
    """Of these rows a few periods' worth: those of the most forceful stretch for a constant
    command, the first ones for a switched one."""
    if rows.all():
        out = np.zeros(len(rows), dtype=bool)
        out[window(run)] = True
        return out
    most = int(np.clip(PERIODS / usual_Hz(run) * run.rate_Hz, 20, MOST_ROWS))
    return rows & (np.cumsum(rows) <= most)


def plot_residual(runs: Sequence[Run]) -> str:
    """Of the longest test: against time, its spectrum, its autocorrelation."""
    plt = pyplot()
    run = max(shown_part(runs), key=lambda one: len(one.model_N))
    figure, axes = plt.subplots(1, 3, figsize=(11, 3.0))
    step = -(-len(run.model_N) // MOST_ROWS)
    axes[0].plot(run.time_s[::step], run.residual_N[::step], color=COLORS["current"], lw=0.5)
    axes[0].set(xlabel="time (s)", ylabel="residual (N)")
    for values, name, label in (
        (run.measured_N - run.measured_N.mean(), "muted", "force"),
        (run.residual_N - run.residual_N.mean(), "current", "residual"),
    ):
        axes[1].loglog(*spectrum(values, run.rate_Hz), color=COLORS[name], lw=0.9, label=label)
    axes[1].set(xlabel="frequency (Hz)", ylabel="N/√Hz")
    axes[1].legend()
    lags = min(len(run.model_N) // 4, max(25, int(run.rate_Hz / usual_Hz(run))), 400)
    found = autocorrelation(run.residual_N, lags)
    axes[2].axhspan(*white_band(len(run.model_N)), color=COLORS["shade"], label="white: 95 %")
    axes[2].plot(np.arange(lags + 1) / run.rate_Hz, found, color=COLORS["main"], lw=0.9)
    axes[2].set(xlabel="lag (s)", ylabel="autocorrelation")
    axes[2].legend()
    return svg_of(figure)


def plot_where(runs: Sequence[Run]) -> str:
    """The error along each test, and parts of the squared error beside parts of the rows."""
    plt = pyplot()
    shown = shown_part(runs)
    courses = [course_of(run) for run in sorted(shown, key=lambda one: -one.error)[:_COURSES]]
    places = places_of(shown)
    height = max(3.0 + 0.2 * len(courses), 0.32 * len(places))
    figure, axes = plt.subplots(1, 2, figsize=(9.5, height))
    for course, shade in zip(courses, _SHADES, strict=False):
        error_pct = 100.0 * course.error
        axes[0].plot(course.time_s, error_pct, color=COLORS[shade], lw=1.1, label=course.label)
    axes[0].set(xlabel="time in the test (s)", ylabel="error (% of its force)", ylim=(0.0, None))
    axes[0].set_title("tests with the largest errors" if len(shown) > _COURSES else "every test")
    axes[0].legend(loc="upper left", bbox_to_anchor=(0.0, -0.18), borderaxespad=0.0)
    at = np.arange(len(places))
    for offset, values, shade, label in (
        (-0.2, [one.rows for one in places], "muted", "of the rows"),
        (0.2, [one.error for one in places], "current", "of the squared error"),
    ):
        axes[1].barh(at + offset, 100.0 * np.array(values), 0.4, color=COLORS[shade], label=label)
    axes[1].set_yticks(at, [one.text for one in places])
    axes[1].invert_yaxis()
    axes[1].set_xlabel("part (%)")
    axes[1].legend()
    return svg_of(figure)


def white_band(count: int) -> tuple[float, float]:
    half = 1.96 / np.sqrt(max(count, 1))
    return -half, half


def spectrum(values: np.ndarray, rate_Hz: float) -> tuple[np.ndarray, np.ndarray]:
    """Amplitude density in N/sqrt(Hz), Welch."""
    from scipy.signal import welch

    freq_Hz, power = welch(values, rate_Hz, nperseg=min(len(values), 2048))
    return freq_Hz[1:], np.sqrt(np.maximum(power[1:], 1e-30))


def plot_errors(models: Sequence[tuple[str, Sequence[Run]]]) -> str:
    """Error of a few models by command, fitted and held-out apart."""
    plt = pyplot()
    tables = [(name, errors_by_command(runs)) for name, runs in models]
    groups = list(dict.fromkeys(group for _, table in tables for group in table))
    figure, axis = plt.subplots(figsize=(9.5, 3.2))
    width = 0.8 / len(models)
    names = ("main", "phase", "constant_best", "fuzzy_selftune_printed")
    for k, (name, table) in enumerate(tables):
        places = np.arange(len(groups)) + (k - 0.5 * (len(models) - 1)) * width
        errors = [table.get(group, 0.0) for group in groups]
        axis.bar(places, errors, width, color=COLORS[names[k % len(names)]], label=name)
    axis.set_xticks(np.arange(len(groups)), groups, rotation=20 if len(groups) > 6 else 0)
    axis.set_ylabel("error (% of the force)")
    axis.legend()
    return svg_of(figure)


def errors_by_command(runs: Sequence[Run]) -> dict[str, float]:
    """Error in % of the force at each command, fitted ones first."""
    sums: dict[str, np.ndarray] = {}
    for run in sorted(runs, key=lambda one: (one.is_test, one.segment.record.level or 0.0)):
        for label, rows in command_parts(run):
            group = f"{label}, held out" if run.is_test else label
            squares = [np.sum(values[rows] ** 2) for values in (run.residual_N, run.measured_N)]
            sums[group] = sums.get(group, np.zeros(2)) + np.array(squares)
    return {
        group: 100.0 * float(np.sqrt(error / max(force, 1e-300)))
        for group, (error, force) in sums.items()
    }


def plot_ranking(fitted: Sequence[Fitted]) -> str:
    """Validation (and test) error over the numbers fitted; filled: passive."""
    plt = pyplot()
    figure, axis = plt.subplots(figsize=(9.5, 4.2))
    found = [one for one in ranked(fitted) if np.isfinite(one.validation_error)]
    for one in found:
        colour = COLORS["main" if one.kind == "parametric" else "current"]
        face = colour if one.passivity.holds else "none"
        at = (max(one.parameter_count, 1), 100.0 * one.validation_error)
        axis.plot(*at, _MARKERS.get(one.kind, "o"), color=colour, mfc=face, ms=6)
        axis.annotate(one.name, at, xytext=(5, 3), textcoords="offset points")
        if one.test and np.isfinite(one.test.error):
            axis.plot([at[0]] * 2, [at[1], 100.0 * one.test.error], color=COLORS["muted"], lw=0.6)
            axis.plot(at[0], 100.0 * one.test.error, "_", color=COLORS["muted"], ms=9)
    axis.set(xlabel="numbers fitted", ylabel="error (% of the force)")
    counts = [max(one.parameter_count, 1) for one in found]
    if found and max(counts) > 5 * min(counts):
        axis.set_xscale("log")
    if found:
        axis.set_yscale("log")
    for one in (axis.xaxis, axis.yaxis):
        one.set_major_formatter("{x:g}")
        one.set_minor_formatter("{x:g}")
    axis.set_title("validation error; dash: held-out test; filled: passive; square: black box")
    return svg_of(figure)
