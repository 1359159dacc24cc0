"""The report of `quiesce hil`: one HTML page that needs nothing beside itself."""

from collections.abc import Sequence

from quiesce.base.paths import default_plant, root
from quiesce.engine import laws
from quiesce.hil.metrics import Beside, Result, Row
from quiesce.hil.plots import (
    plot_reductions,
    plot_rig,
    plot_searches,
    plot_spectra,
    plot_steady,
    plot_step,
    plot_surface,
    scenario_names,
)
from quiesce.hil.rig_table import LEFT, rig_tables
from quiesce.hil.rule_surface import RuleSurface
from quiesce.hil.runs import ConstantSearch, Run
from quiesce.hil.table import (
    compared_text,
    difference,
    groups,
    instruction_lines,
    published_difference,
    published_text,
    target_name,
)
from quiesce.report.page import render


def text(value: float | None, digits: int = 1) -> str:
    return "" if value is None else f"{value:.{digits}f}".replace("-", "\u2212")


def signed(value: float | None) -> str:
    if value is None:
        return ""
    return "0.0" if round(value, 1) == 0 else f"{value:+.1f}".replace("-", "\u2212")


def in_symbols(heading: str) -> str:
    return heading.replace(" um", " µm").replace("mm/s2", "mm/s²")


def cells(row: Row, beside: Beside) -> list[tuple[str, str]]:
    """Classes and text of what stands behind the law."""
    amp, accel = row.amp_reduction_pct, row.accel_rms_reduction_pct
    sim_amp = beside.simulated.get("amp_reduction_pct")
    sim_accel = beside.simulated.get("accel_rms_reduction_pct")
    return [
        ("left", row.target),
        ("sep", "" if beside.published is None else published_text(beside.published)),
        ("ours", text(amp)),
        ("diff", signed(published_difference(amp, beside.published))),
        ("", text(sim_amp)),
        ("diff", signed(difference(amp, sim_amp))),
        ("", text(row.bound_amp_pct)),
        ("diff", signed(difference(amp, row.bound_amp_pct))),
        ("ours sep", text(accel)),
        ("", text(sim_accel)),
        ("diff", signed(difference(accel, sim_accel))),
        ("", text(row.bound_accel_rms_pct)),
        ("diff", signed(difference(accel, row.bound_accel_rms_pct))),
        ("sep", text(row.mean_current_A, 2)),
        ("", text(row.settle_s, 3)),
        ("", text(row.rms_disp_um)),
    ]


def make_page(
    result: Result,
    runs: Sequence[Run],
    searches: Sequence[ConstantSearch],
    surface: RuleSurface,
    command: str,
) -> str:
    plain = [run for run in runs if run.case.scenario.board is None]
    compared = [
        (
            in_symbols(heading),
            [(laws.find(r.law).label, cells(r, b)) for r, b in members if r.law != laws.OPEN_LOOP],
        )
        for heading, members in groups(result)
    ]
    equal = result.trace_equal
    return render(
        "hil/page.html.j2",
        result=result,
        equal=equal,
        compared_with=equal and target_name(equal["targets"][1]),
        compared_what=equal and compared_text(equal["telemetry_every"]),
        worst=max(
            (row.instr_worst for row in result.rows if row.instr_worst is not None), default=0
        ),
        compared=compared,
        tables=rig_tables(result.rigs),
        left=LEFT,
        rigs={
            name: plot_rig(runs, name) for name in dict.fromkeys(r.scenario for r in result.rigs)
        },
        steps={name: plot_step(plain, name) for name in scenario_names(plain, is_step=True)},
        reductions=plot_reductions(result),
        steady=plot_steady(plain),
        spectra=plot_spectra(plain),
        surface=plot_surface(surface, plain),
        searches=plot_searches(searches),
        counts="\n".join(instruction_lines(result)),
        command=command,
        plant=default_plant().relative_to(root()),
    )
