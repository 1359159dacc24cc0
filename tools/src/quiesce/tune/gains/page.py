"""The page of a tuning: what it reached, trials over each setting and one after the other."""

from math import ceil

import numpy as np

from quiesce.report.page import render
from quiesce.report.plot_style import COLORS, pyplot, svg_of
from quiesce.tune.gains.run import Tuned
from quiesce.tune.gains.space import Dimension

Rows = tuple[list[str], list[list[str]]]
IN_A_ROW = 4
SHOWN_COST = 2.0  # of the best: what is worse is drawn at this edge


def page(tuned: Tuned, values: Rows, records: Rows, compare: str) -> str:
    return render(
        "tune/gains/page.html.j2",
        tuned=tuned,
        values=values,
        records=records,
        compare=compare,
        refused=sum(not one.runs for one in tuned.trials),
        over_settings=_over_settings(tuned),
        over_time=_over_time(tuned),
    )


def _over_settings(tuned: Tuned) -> str:
    searched = tuned.tunable.space.searched
    if not searched:
        return ""
    plt = pyplot()
    lines = ceil(len(searched) / IN_A_ROW)
    figure, axes = plt.subplots(
        lines, IN_A_ROW, figsize=(11, 2.6 * lines), sharey=True, squeeze=False
    )
    for at, one in zip(axes.flat, searched, strict=False):
        _of_setting(at, tuned, one)
    for at in axes.flat[len(searched) :]:
        at.set_axis_off()
    for row in axes:
        row[0].set_ylabel("minimised")
    return svg_of(figure)


def _of_setting(at: object, tuned: Tuned, one: Dimension) -> None:
    done = [trial for trial in tuned.trials if trial.runs]
    edge = SHOWN_COST * tuned.cost(tuned.best.runs)
    costs = [min(edge, tuned.cost(trial.runs)) for trial in done]
    at.plot([trial.values[one.name] for trial in done], costs, ".", color=COLORS["muted"])
    at.plot(
        [tuned.best.values[one.name]], [tuned.cost(tuned.best.runs)], "o", color=COLORS["current"]
    )
    if one.is_log:
        at.set_xscale("log")
    at.set_xlim(one.low, one.high)
    at.set_xlabel(one.name)


def _over_time(tuned: Tuned) -> str:
    plt = pyplot()
    figure, at = plt.subplots(figsize=(9, 3))
    edge = SHOWN_COST * tuned.cost(tuned.best.runs)
    costs = np.array([tuned.cost(one.runs) for one in tuned.trials])
    numbers = np.arange(1, len(costs) + 1)
    at.plot(numbers, np.minimum(costs, edge), ".", color=COLORS["muted"], label="trial")
    at.step(numbers, np.minimum.accumulate(costs), where="post", color=COLORS["main"], label="best")
    best = min(tuned.cost(one) for one in tuned.constants)
    at.axhline(best, color=COLORS["constant_best"], label="best constant current")
    at.set_xlabel("trial")
    at.set_ylabel("minimised")
    at.legend()
    return svg_of(figure)
