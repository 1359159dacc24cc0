"""One picture of a run: the structure without and with control, and the current that did it."""

from collections.abc import Sequence

import numpy as np

from quiesce.engine import laws
from quiesce.hil.plots import label, one_run_a_law
from quiesce.hil.runs import Run
from quiesce.report.plot_style import COLORS, pyplot, svg_of

# Shown with preference: the law that comes nearest to the bound.
FIRST_CHOICE = "phase"
BEFORE_STEP_s, AFTER_STEP_s = 0.4, 0.6
STEADY_s = 1.0


def plot_picture(runs: Sequence[Run]) -> str:
    """Displacement in open loop and under one law, and its current; "" without such a pair."""
    for name in shown_first(runs):
        found = one_run_a_law(runs, name)
        free = found.pop(laws.OPEN_LOOP, None)
        if free is not None and found:
            law = FIRST_CHOICE if FIRST_CHOICE in found else next(iter(found))
            return draw(free, found[law], law)
    return ""


def shown_first(runs: Sequence[Run]) -> list[str]:
    """The names of the scenarios, those with a step first."""
    ordered = sorted((run.case.scenario for run in runs), key=lambda found: not found.is_step)
    return list(dict.fromkeys(scenario.name for scenario in ordered))


def window_of(run: Run) -> tuple[np.ndarray, np.ndarray]:
    """Times in s after the step, or before the end where there is none; which of them are shown."""
    step_s = run.case.scenario.transient_s
    if step_s is None:
        time_s = run.trace["t_s"] - run.trace["t_s"][-1]
        return time_s, time_s > -STEADY_s
    time_s = run.trace["t_s"] - step_s
    return time_s, (time_s > -BEFORE_STEP_s) & (time_s < AFTER_STEP_s)


def draw(free: Run, held: Run, law: str) -> str:
    figure, axes = pyplot().subplots(2, 1, figsize=(8, 3.4), sharex=True, height_ratios=[3, 1.2])
    names = {laws.OPEN_LOOP: (free, "without control"), law: (held, label(law))}
    for name, (run, text) in names.items():
        time_s, shown = window_of(run)
        axes[0].plot(time_s[shown], run.trace["x5_um"][shown], color=COLORS[name], label=text)
    axes[1].plot(time_s[shown], held.trace["coil_A"][shown], color=COLORS[law])
    axes[0].set_ylabel("displacement (µm)")
    axes[1].set_ylabel("current (A)")
    is_step = free.case.scenario.is_step
    axes[1].set_xlabel(f"time {'after the step' if is_step else 'before the end'} (s)")
    axes[0].set_title(free.case.scenario.name)
    axes[0].legend(loc="upper right", ncols=2)
    axes[1].set_xlim(time_s[shown][0], time_s[shown][-1])
    figure.align_ylabels(axes)
    return svg_of(figure)
