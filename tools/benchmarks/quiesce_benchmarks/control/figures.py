"""The figures of `./tools/benchmark control`, with their goals.

All with 0.5 mg noise and the plant's own ADC, driver and coil; reductions are against 0 A, by the
definitions of docs/howto/describe-a-plant.md. Unless said otherwise the law adapts from a cold
start.

amp_red, accel_red     displacement setting, last 2 s of 8 s of a sine: the pulses that were tuned
                       for this plant (the adaptation begins after 10 s)
*_adapted_*            the same in the last 2 s of 120 s: what the adaptation makes of them
balanced_*             balanced setting, likewise
sweep_*_min_fraction   least share, over 4 .. 22 Hz, of the displacement bound; balanced: of the
                       bound with acceleration no worse than at 0 A
sweep_worst_below_constant   either setting, from 10 Hz on, against all the current there is
step_*                 displacement setting, change at 4 s; peak and RMS in the 2 s after it
robust_*               displacement setting, last 2 s of 120 s, each plant against its own bound and
                       its own best constant current; converged: 10 s on end within 2 % of the last
                       10 s; dither: mean of the last 30 s over the best tenth of them
broadband_*            balanced setting, from rest to the end; displacement and acceleration each
                       against the constant current that is best for it
chirp_low_fraction     displacement setting: reduction of the mean half peak-to-peak of the cycles
                       from 4 to 10 Hz, over that at the interpolated bound
worst_cycle_work       of the damper on the structure, last 2 s of 20 s, either setting, on the
                       plant and on one whose current switches a stiffness; negative dissipates
inverted_*             accel_polarity -1: setting displacement against constant
                       unlock_current_mA; either setting against itself with the right sign
day_*                  balanced setting, a fault every few seconds; lost: at the end against a run
                       without faults
"""

from collections.abc import Callable, Sequence
from typing import Any

from quiesce_benchmarks.control.broadband import low_fraction, mean_current_A, worst_ratio
from quiesce_benchmarks.control.cost import Counted, added_worst_instr
from quiesce_benchmarks.control.rig import BALANCED, DISPLACEMENT, Rig
from quiesce_benchmarks.control.robust import Cell
from quiesce_benchmarks.control.ruler import Ruler
from quiesce_benchmarks.control.safety import worst_inversion_pts, worst_inverted_pts, worst_work_uJ
from quiesce_benchmarks.control.steady import Point, POINTS_Hz, judge_sweep, least
from quiesce_benchmarks.control.steps import find
from quiesce_benchmarks.control.suite import Results
from quiesce_benchmarks.report import Figure

# Least reductions of setting `displacement` on the published plant: displacement, acceleration.
POINT_GOALS_pct = {5.0: (17.0, -1.0), 10.0: (26.0, 25.8), 15.0: (26.0, 25.4), 20.0: (25.5, 21.0)}
BALANCED_GOALS_pct = (14.0, 6.5)
# The sweep's allowance for being below a constant current: what a law that is as good may measure.
ALLOWANCE_pts = 0.5
DAY_LOST_pts = 1.0
ADDED_GOAL_INSTR = 200
TABLE_GOAL_BYTES = 2048

# Goals that only make sense on the published plant come as goal(value): None on any other.
Goal = Callable[[float], float | None]


def goal_for(ruler: Ruler) -> Goal:
    return lambda value: value if ruler.is_published else None


def point_figures(points: Sequence[Point], goal: Goal) -> list[Figure]:
    by_freq = {point.freq_Hz: point for point in points}
    out, adapted = [], []
    for freq_Hz in POINTS_Hz:
        found = by_freq[freq_Hz].shipped[DISPLACEMENT]
        amp_goal, accel_goal = (goal(value) for value in POINT_GOALS_pct[freq_Hz])
        name = f"{freq_Hz:g}Hz_pct"
        out.append(Figure(f"amp_red_{name}", found.amp_pct, "%", amp_goal, "higher"))
        out.append(Figure(f"accel_red_{name}", found.accel_pct, "%", accel_goal, "higher"))
        later = by_freq[freq_Hz].adapted[DISPLACEMENT]
        adapted.append(Figure(f"amp_red_adapted_{name}", later.amp_pct, "%", None, "higher"))
        adapted.append(Figure(f"accel_red_adapted_{name}", later.accel_pct, "%", None, "higher"))
    balanced = by_freq[5.0].shipped[BALANCED]
    amp_goal, accel_goal = (goal(value) for value in BALANCED_GOALS_pct)
    current_A = by_freq[10.0].shipped[DISPLACEMENT].mean_current_A
    return [
        *out,
        Figure("balanced_amp_red_5Hz_pct", balanced.amp_pct, "%", amp_goal, "higher"),
        Figure("balanced_accel_red_5Hz_pct", balanced.accel_pct, "%", accel_goal, "higher"),
        Figure("mean_current_10Hz_A", current_A, "A", goal(3.8), "lower"),
        *adapted,
    ]


def sweep_figures(points: Sequence[Point], ruler: Ruler) -> list[Figure]:
    sweep = judge_sweep(points, ruler)
    return [
        Figure("sweep_displacement_min_fraction", sweep.displacement_min_fraction, "1", 0.9,
               "higher"),
        Figure("sweep_balanced_min_fraction", sweep.balanced_min_fraction, "1", 0.9, "higher"),
        Figure("sweep_balanced_min_accel_pct", sweep.balanced_min_accel_pct, "%", -1.0, "higher"),
        Figure("sweep_worst_below_constant_pts", sweep.worst_below_constant_pts, "pts",
               ALLOWANCE_pts, "lower"),
    ]  # fmt: skip


def step_figures(results: Results, goal: Goal) -> list[Figure]:
    """Setting `displacement`, the change at 4 s after a cold start."""
    up, to_resonance = find(results.steps, 20.0), find(results.steps, 10.0)
    return [
        Figure("step_10_20_settle_s", up.settle_s, "s", goal(0.35), "lower"),
        Figure("step_10_20_rms_disp_um", up.rms_disp_um, "um", goal(13.8), "lower"),
        Figure("step_5_10_peak_um", to_resonance.peak_um, "um", goal(125.0), "lower"),
        Figure("step_5_10_settle_s", to_resonance.settle_s, "s", goal(0.4), "lower"),
    ]


def robust_figures(cells: Sequence[Cell]) -> list[Figure]:
    below = max(cell.below_constant_pts for cell in cells)
    converge_s = max(cell.converge_s for cell in cells)
    dither = max(cell.dither_loss_pct for cell in cells)
    return [
        Figure("robust_min_fraction", least([c.fraction for c in cells]), "1", 0.9, "higher"),
        Figure("robust_worst_below_constant_pts", below, "pts", 1.0, "lower"),
        Figure("robust_converge_s", converge_s, "s", None, "lower"),
        Figure("robust_dither_loss_pts", dither, "pts", None, "lower"),
    ]


def broadband_figures(results: Results, ruler: Ruler, is_whole: bool) -> list[Figure]:
    """Setting `balanced`, the default, but the chirp's, which is about displacement alone.
    is_whole: every input of the set was there."""
    disp, accel, current_A = (
        worst_ratio(results.inputs, BALANCED, "disp"),
        worst_ratio(results.inputs, BALANCED, "accel"),
        mean_current_A(results.inputs, BALANCED),
    )
    low = low_fraction(results.chirp[0], DISPLACEMENT, ruler)
    return [
        Figure("broadband_worst_disp_ratio", disp if is_whole else None, "1", 1.02, "lower"),
        Figure("broadband_worst_accel_ratio", accel if is_whole else None, "1", 1.02, "lower"),
        Figure("broadband_mean_current_A", current_A if is_whole else None, "A", 4.0, "lower"),
        Figure("chirp_low_fraction", low, "1", 0.7, "higher"),
    ]


def safety_figures(results: Results) -> list[Figure]:
    day = results.day[0]
    inverted = worst_inverted_pts(results.inverted)
    return [
        Figure("worst_cycle_work_uJ", worst_work_uJ(results.work), "uJ", 0.0, "lower"),
        Figure("inverted_worst_below_unlock_pts", inverted, "pts", ALLOWANCE_pts, "lower"),
        Figure(
            "inverted_worst_change_pts",
            worst_inversion_pts(results.inverted),
            "pts",
            ALLOWANCE_pts,
            "lower",
        ),
        Figure("day_samples_outside_limits", day.outside_limits, "1", 0, "lower"),
        Figure("day_lost_pts", day.lost_pts, "pts", DAY_LOST_pts, "lower"),
    ]


def cost_figures(rig: Rig, counted: Sequence[Counted], table_bytes: int | None) -> list[Figure]:
    law = rig.judged.law
    added = added_worst_instr(counted, law) if counted else None
    mismatches = sum(one.mismatches for one in counted) if counted else None
    return [
        Figure("host_image_mismatches", mismatches, "1", 0, "lower"),
        Figure("law_added_worst_instr", added, "instr", ADDED_GOAL_INSTR, "lower"),
        Figure("law_table_bytes", table_bytes, "byte", TABLE_GOAL_BYTES, "lower"),
    ]


def all_figures(
    rig: Rig,
    ruler: Ruler,
    results: Results,
    counted: Sequence[Counted],
    table_bytes: int | None,
    has_earthquakes: bool,
) -> list[Figure]:
    goal = goal_for(ruler)
    under = ruler.worst_under_pts()
    return [
        *point_figures(results.points, goal),
        *sweep_figures(results.points, ruler),
        *step_figures(results, goal),
        *robust_figures(results.cells),
        *broadband_figures(results, ruler, has_earthquakes),
        *safety_figures(results),
        Figure("own_bound_worst_under_pts", under, "pts", goal(0.5), "lower"),
        *cost_figures(rig, counted, table_bytes),
    ]


def context_of(
    ruler: Ruler, results: Results, counted: Sequence[Counted], facts: dict[str, Any]
) -> dict[str, Any]:
    """All that was measured, as values of JSON."""
    return {
        **facts,
        "steady": [
            {**point.row(), "bound": vars(ruler.bound(point.freq_Hz))} for point in results.points
        ],
        "steps": [step.row() for step in results.steps],
        "robust": [cell.row() for cell in results.cells],
        "robust_extra": [cell.row() for cell in results.extra_cells],
        "broadband": [one.row() for one in results.inputs],
        "chirp": results.chirp[0].row(ruler),
        "work": [one.row() for one in results.work],
        "inverted": [one.row() for one in results.inverted],
        "day": results.day[0].row(),
        "cost": [one.row() for one in counted],
        "own_bounds": ruler.own_under(),
    }
