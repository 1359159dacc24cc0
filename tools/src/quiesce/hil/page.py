"""The report of `quiesce hil`: one HTML page that needs nothing beside itself."""

import html
from collections.abc import Sequence

from quiesce.base.paths import default_plant, root, typed
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
from quiesce.report.html import card, cards, document, html_table, image, section


def text(value: float | None, digits: int = 1) -> str:
    return "" if value is None else f"{value:.{digits}f}".replace("-", "\u2212")


def signed(value: float | None) -> str:
    if value is None:
        return ""
    return "0.0" if round(value, 1) == 0 else f"{value:+.1f}".replace("-", "\u2212")


def in_symbols(heading: str) -> str:
    return heading.replace(" um", " µm").replace("mm/s2", "mm/s²")


def result_cards(result: Result) -> str:
    parts = []
    equal = result.trace_equal
    if equal:
        parts.append(
            card(
                f"{equal['mismatches']} mismatches",
                f"{target_name(equal['targets'][1])} against host, "
                f"{compared_text(equal['telemetry_every'])} of {equal['ticks']:,} ticks, "
                f"{len(equal['seeds'])} seeds, {equal['distinct_commands']:,} distinct commands",
                is_bad=equal["mismatches"] > 0,
            )
        )
    names = {
        "host": "real time: closed loop here",
        "mps2": "real time: the image in QEMU",
        "mps2-uart": "real time: the image over its UART",
        "linux": "real time: quiesced over CAN",
    }
    for target, factor in result.realtime_factor.items():
        if factor is not None:
            parts.append(card(f"{factor:.{1 if factor < 10.0 else 0}f} ×", names[target]))
    worst = [row.instr_worst for row in result.rows if row.instr_worst is not None]
    if worst:
        parts.append(card(f"{max(worst):,}", "instructions in the worst tick of all runs"))
    if result.uart:
        parts.append(
            card(
                f"{result.uart['ratio']:.2f}",
                "of a raw echo's rate over the UART: "
                f"{result.uart['protocol_per_s']:.0f} exchanges/s, "
                f"{result.uart['realtime_factor']:.2f} × real time",
            )
        )
    return cards(parts)


def table_row(row: Row, beside: Beside) -> str:
    amp, accel = row.amp_reduction_pct, row.accel_rms_reduction_pct
    sim_amp = beside.simulated.get("amp_reduction_pct")
    sim_accel = beside.simulated.get("accel_rms_reduction_pct")
    published = "" if beside.published is None else published_text(beside.published)
    cells = [
        ("left", laws.find(row.law).label),
        ("left", row.target),
        ("sep", published),
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
    return "<tr>" + "".join(f'<td class="{c}">{html.escape(t)}</td>' for c, t in cells) + "</tr>"


def table(result: Result) -> str:
    head = (
        '<tr><th rowspan="2">law</th><th rowspan="2">on</th>'
        '<th class="group sep" colspan="7">displacement amplitude, reduction %</th>'
        '<th class="group sep" colspan="5">RMS acceleration, reduction %</th>'
        '<th class="sep" rowspan="2">mean<br>A</th><th rowspan="2">settles<br>s</th>'
        '<th rowspan="2">RMS<br>µm</th></tr>'
        '<tr><th class="sep">published</th><th>ours</th><th>diff</th><th>simulated</th>'
        "<th>diff</th><th>bound</th><th>diff</th>"
        '<th class="sep">ours</th><th>simulated</th><th>diff</th><th>bound</th><th>diff</th></tr>'
    )
    body = []
    for heading, members in groups(result):
        heading = html.escape(in_symbols(heading))
        body.append(f'<tr class="head"><td colspan="17">{heading}</td></tr>')
        body += [table_row(r, b) for r, b in members if r.law != laws.OPEN_LOOP]
    rows = f"<thead>{head}</thead><tbody>{''.join(body)}</tbody>"
    return f'<div class="wide"><table>{rows}</table></div>'


def comparison(result: Result) -> str:
    """Against published figures, of plants without a board."""
    if not result.plain:
        return ""
    return f"""<h2>Comparison</h2>
{table(result)}
<p><b>Published</b>: measured by the paper on the real structure. <b>Simulated</b>: an independent
simulation of this plant, sine cases without sensor noise. <b>Bound</b>: the best that any current
waveform does on this plant (best found, ±0.5). Each <b>diff</b> is ours less the figure before it;
for a published range, less its nearer end. <b>On</b>: “both” where host and the other target agree
to every digit. The reversed sign of self-tuning stands beside the same published figure: the
paper's printed table has the sign that makes 5 Hz worse on this plant.</p>"""


def rigs(result: Result, runs: Sequence[Run]) -> str:
    """Bodies and dampers of scenarios with a board."""
    if not result.rigs:
        return ""
    parts = ["<h2>Bodies and dampers</h2>"]
    for heading, bodies, dampers in rig_tables(result.rigs):
        parts += [f"<h3>{html.escape(heading)}</h3>", html_table(bodies, LEFT)]
        parts.append(html_table(dampers, LEFT))
    parts.append(
        "<p>True values of the simulated plant. <b>red.</b>: less than with law off; <b>more</b>: "
        "of a damper's peak force, against law off.</p>"
    )
    for name in dict.fromkeys(row.scenario for row in result.rigs):
        parts.append(
            section(
                f"The end of {name}",
                "True displacement of each body, force and coil current of each damper.",
                image(plot_rig(runs, name), "displacements, forces and currents against time"),
            )
        )
    return "".join(parts)


def conditions(row: Row, has_board: bool) -> str:
    """With a board each sensor has its own noise."""
    noise = "" if has_board else f"Sensor noise {row.noise_mg:g} mg, drive"
    return f"{noise or 'Drive'}\n{row.drive_V:g} V, seed {row.seed}."


def figures(
    result: Result, runs: Sequence[Run], searches: Sequence[ConstantSearch], surface: RuleSurface
) -> str:
    parts = [
        section(
            "Reductions in the steady state",
            "Bars are ours. Marks stand on the bar that they belong to.",
            image(plot_reductions(result), "reductions by frequency and law"),
        )
    ]
    for name in scenario_names(runs, is_step=True):
        parts.append(
            section(
                f"The frequency step: {name}",
                "True displacement and coil current, and the frequency that the firmware "
                "estimates. While it is not valid the current is <code>unlock_current_mA</code>.",
                image(plot_step(runs, name), f"time traces around the step of {name}"),
            )
        )
    parts += [
        section(
            "The last periods of each steady run",
            "True values at each control tick. Where laws agree, their curves cover each other.",
            image(plot_steady(runs), "displacement, acceleration and current against time"),
        ),
        section(
            "Spectrum of the acceleration",
            "Amplitude under a Hann window over the steady state. At 5 Hz a damper that sticks "
            "makes a third harmonic, which excites the structure near its resonance.",
            image(plot_spectra(runs), "amplitude spectra of the acceleration"),
        ),
        section(
            "Rule surface and the cells that were visited",
            "The rule base of the fuzzy law, evaluated by the firmware.",
            image(plot_surface(surface, runs), "current over frequency and RMS acceleration"),
        ),
        section(
            "Constant currents",
            "The best constant current is searched, not assumed: the smallest displacement over "
            "this grid.",
            image(plot_searches(searches), "reductions against constant current"),
        ),
    ]
    return "".join(parts)


def make_page(
    result: Result,
    runs: Sequence[Run],
    searches: Sequence[ConstantSearch],
    surface: RuleSurface,
    command: str,
) -> str:
    has_board = not result.plain
    drive = conditions(result.rows[0], has_board)
    counts = "\n".join(instruction_lines(result))
    return document(
        "closed loop, published against ours",
        f"""<h1>Closed loop: published, ours, best attainable</h1>
<p class="lead">The controller's firmware against the simulated structure, in lock-step, one
acceleration sample and one current command each control tick. Reductions are against 0 A with the
same excitation; negative is worse than doing nothing. {drive}</p>
{result_cards(result)}
{comparison(result)}
{rigs(result, runs)}
{figures(result, [r for r in runs if r.case.scenario.board is None], searches, surface)}
{f"<h2>Instructions of the image</h2><pre>{html.escape(counts)}</pre>" if counts else ""}
<h2>Run it again</h2>
<pre>{html.escape(command)}
{typed("quiesce hil")} --quick                                        # a shorter run
{typed("quiesce hil")} --scenario step_10_20Hz --law fuzzy --target host
{typed("quiesce hil")} --help</pre>
<p>The same figures for a script: <code>metrics.json</code> beside this page;
<code>details.json</code> has the search over constant currents and the UART rate. Scenarios:
<code>sim_hil/data/scenarios/</code>, the plant:
<code>{default_plant().relative_to(root())}</code>, published figures and bound with their sources:
<code>sim_hil/data/scenarios/reference_squeeze.toml</code>.</p>""",
    )
