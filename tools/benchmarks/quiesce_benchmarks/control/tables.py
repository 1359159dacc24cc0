"""The tables that `./tools/benchmark control` prints below its figures."""

from collections.abc import Sequence
from statistics import median

from quiesce.base.table import format_table
from quiesce.hil.published import Reference

from quiesce_benchmarks.control.broadband import ChirpResult, Input, low_fraction
from quiesce_benchmarks.control.cost import Counted
from quiesce_benchmarks.control.rig import BALANCED, DISPLACEMENT, SETTINGS, Reduction
from quiesce_benchmarks.control.robust import Cell, FREQS_Hz
from quiesce_benchmarks.control.ruler import Ruler
from quiesce_benchmarks.control.safety import Day, Inverted, Work
from quiesce_benchmarks.control.steady import Point, POINTS_Hz
from quiesce_benchmarks.control.steps import StepResult

WORST_CELLS = 12


def number(value: float | None, digits: int = 1) -> str:
    return "-" if value is None else f"{value:.{digits}f}"


def pair(one: Reduction) -> str:
    return f"{one.amp_pct:.1f} / {one.accel_pct:.1f}"


def titled(title: str, head: Sequence[str], rows: Sequence[Sequence[str]], left=(0,)) -> str:
    return f"{title}\n{format_table(head, rows, left)}"


def published_text(reference: Reference | None, freq_Hz: float) -> str:
    """What the paper measured with its fuzzy law at this frequency."""
    case = reference and reference.published_for(f"sine_{freq_Hz:g}Hz", "fuzzy", freq_Hz)
    if not case:
        return "-"
    if case.low_pct == case.high_pct:
        return f"{case.low_pct:g}"
    return f"{case.low_pct:g}-{case.high_pct:g}"


def point_rows(point: Point, ruler: Ruler, reference: Reference | None) -> list[tuple[str, ...]]:
    """Name, reductions, then what there is of: mean current, bound, convergence, dither."""
    bound = ruler.bound(point.freq_Hz)
    limits = {DISPLACEMENT: bound.amp_pct, BALANCED: bound.balanced_amp_pct}
    rows: list[tuple[str, ...]] = [
        ("published, fuzzy", published_text(reference, point.freq_Hz)),
        ("full constant current", pair(point.full), number(point.full.mean_current_A, 2)),
        ("fuzzy", pair(point.fuzzy), number(point.fuzzy.mean_current_A, 2)),
    ]
    for name in SETTINGS:
        shipped, adapted = point.shipped[name], point.adapted[name]
        current_A = number(adapted.mean_current_A, 2)
        rows += [
            (f"{name}, table alone", pair(shipped), number(shipped.mean_current_A, 2)),
            (
                f"{name}, adapted", pair(adapted), current_A, number(limits[name]),
                number(point.converge_s[name], 0), number(point.dither_loss_pct[name], 2),
            ),
        ]  # fmt: skip
    both = f"{number(bound.amp_pct)} / {number(bound.accel_pct)}"
    return [*rows, ("bound, each alone", both)]


def point_table(points: Sequence[Point], ruler: Ruler, reference: Reference | None) -> str:
    head = ["", "", "amp / accel %", "mean A", "amp bound %", "converged s", "dither pts"]
    rows = []
    for point in points:
        if point.freq_Hz not in POINTS_Hz:
            continue
        for i, cells in enumerate(point_rows(point, ruler, reference)):
            label = "" if i else f"{point.freq_Hz:g} Hz"
            rows.append([label, *cells, *[""] * (len(head) - 1 - len(cells))])
    return titled("steady sines: reductions against 0 A", head, rows, (0, 1))


def sweep_table(points: Sequence[Point], ruler: Ruler) -> str:
    rows = []
    for point in points:
        bound = ruler.bound(point.freq_Hz)
        cells = [pair(point.full)]
        cells += [pair(point.adapted[name]) for name in SETTINGS]
        cells += [number(point.adapted[name].mean_current_A, 2) for name in SETTINGS]
        cells += [number(bound.amp_pct), number(bound.accel_pct), number(bound.balanced_amp_pct)]
        rows.append([f"{point.freq_Hz:g}", *cells])
    head = ["Hz", "full constant", *SETTINGS, "A", "A", "bound amp", "bound accel",
            "amp, accel >= 0"]  # fmt: skip
    return titled("sweep: amp / accel reduction in %, mean current, bounds", head, rows)


def step_table(steps: Sequence[StepResult]) -> str:
    rows = [
        [
            f"{one.from_Hz:g} -> {one.to_Hz:g} Hz at {one.at_s:g} s",
            one.control,
            number(one.settle_s, 3),
            number(one.rms_disp_um, 2),
            number(one.peak_um, 1),
            number(one.mean_current_A, 2),
        ]
        for one in steps
    ]
    head = ["step", "", "settled s", "RMS um, 2 s", "peak um", "mean A"]
    return titled("steps: in the 2 s after the change; mean current at the end", head, rows, (0, 1))


def robust_table(cells: Sequence[Cell]) -> str:
    rows = []
    for freq_Hz in FREQS_Hz:
        some = [cell for cell in cells if cell.freq_Hz == freq_Hz]
        if not some:
            continue
        fractions = [cell.fraction for cell in some if cell.fraction is not None]
        converged = [cell.converge_s for cell in some]
        rows.append(
            [
                f"{freq_Hz:g} Hz",
                str(len(some)),
                number(min(fractions, default=None), 3),
                number(median(fractions) if fractions else None, 3),
                str(sum(fraction < 0.9 for fraction in fractions)) if fractions else "-",
                number(max(cell.below_constant_pts for cell in some), 2),
                number(median(converged), 0),
                number(max(converged), 0),
                number(max(cell.dither_loss_pct for cell in some), 2),
                number(max(c.constant_amp_pct - c.shipped_amp_pct for c in some), 2),
            ]
        )
    head = ["", "plants", "least of bound", "median", "below 0.9", "below constant pts",
            "converged s, median", "worst", "dither pts, worst",
            "table alone below constant"]  # fmt: skip
    return titled("robustness: displacement setting, other plants without retuning", head, rows)


def cell_table(title: str, cells: Sequence[Cell]) -> str:
    rows = [
        [
            cell.variation.label,
            f"{cell.freq_Hz:g}",
            number(cell.shipped_amp_pct),
            number(cell.amp_pct),
            number(cell.accel_pct),
            number(cell.mean_current_A, 2),
            f"{cell.constant_amp_pct:.1f} at {cell.constant_A:g} A",
            number(cell.bound_amp_pct),
            number(cell.fraction, 3),
            number(cell.converge_s, 0),
        ]
        for cell in cells
    ]
    head = ["plant", "Hz", "table alone", "adapted amp", "accel", "mean A", "best constant",
            "bound", "of bound", "converged s"]  # fmt: skip
    return titled(title, head, rows)


def worst_cells(cells: Sequence[Cell]) -> list[Cell]:
    """Those farthest below the bound, or below the best constant where no bound is known."""

    def rank(cell: Cell) -> float:
        return -cell.below_constant_pts if cell.fraction is None else cell.fraction

    return sorted(cells, key=rank)[:WORST_CELLS]


def broadband_table(inputs: Sequence[Input]) -> str:
    rows = [
        [
            one.name,
            number(one.open_loop.rms_disp_um, 1),
            number(one.open_loop.accel_rms_mm_s2, 1),
            f"{one.constant_disp_A:g}",
            f"{one.constant_accel_A:g}",
            *(
                text
                for name in SETTINGS
                for text in (
                    number(one.disp_ratio(name), 3),
                    number(one.accel_ratio(name), 3),
                    number(one.accel_ratio_of_disp(name), 3),
                    number(one.law[name].mean_current_A, 2),
                )
            ),
        ]
        for one in inputs
    ]
    each = ["disp", "accel", "accel*", "A"]
    head = ["input", "0 A um", "0 A mm/s2", "best A disp", "accel",
            *(f"{name[:4]}. {text}" for name in SETTINGS for text in each)]  # fmt: skip
    title = (
        "other inputs: RMS over that of the best constant current for it (accel*: of the constant "
        "that is best for displacement)"
    )
    return titled(title, head, rows)


def chirp_table(chirp: ChirpResult, ruler: Ruler) -> str:
    rows = [
        [name, number(chirp.low_reduction_pct(name)), number(low_fraction(chirp, name, ruler), 3)]
        for name in chirp.peaks_um
    ]
    title = f"chirp, 4 to 10 Hz: amp reduction; the bound's is {number(chirp.low_bound_pct(ruler))}"
    return titled(title, ["", "amp %", "of bound"], rows)


def work_table(work: Sequence[Work], inverted: Sequence[Inverted]) -> str:
    groups: dict[str, list[Work]] = {}
    for one in work:
        groups.setdefault(f"{one.plant}, {one.setting}", []).append(one)
    rows = []
    for name, some in groups.items():
        worst = max(some, key=lambda one: one.work_uJ)
        rows.append([f"work on the plant {name}", f"{worst.freq_Hz:g}",
                     f"{worst.work_uJ:.4g} uJ a cycle"])  # fmt: skip
    for name in SETTINGS:
        turned = max(
            (one for one in inverted if one.setting == name), key=lambda one: one.below_unlock_pts
        )
        rows.append(
            [
                f"accelerometer inverted, {name}",
                f"{turned.freq_Hz:g}",
                f"{turned.amp_pct:.1f} %, unlock current {turned.unlock_amp_pct:.1f} %, "
                f"upright {turned.upright_amp_pct:.1f} %",
            ]
        )
    return titled("safety: the worst frequency", ["", "Hz", ""], rows, (0, 2))


def day_table(day: Day) -> str:
    rows = [
        ["hours", number(day.hours, 2)],
        ["faults injected", str(day.faults_injected)],
        ["faults noticed", str(day.faults_noticed)],
        ["trials of the adaptation", number(day.trials, 0)],
        ["largest trim of an edge, degrees", number(day.largest_trim_deg, 2)],
        ["least level", number(day.least_level, 3)],
        ["samples outside the limits", number(day.outside_limits, 0)],
        ["runs at the end", "yes" if day.final_state_is_run else "no"],
        ["amp reduction at the end, %", number(day.amp_pct, 2)],
        ["without faults, %", number(day.undisturbed_amp_pct, 2)],
    ]
    return titled("a day of faults", ["", ""], rows)


def cost_table(counted: Sequence[Counted]) -> str:
    rows = [
        [one.scenario, one.law, one.setting, f"{one.worst_instr:,}", f"{one.median_instr:,}",
         f"{one.ticks:,}", str(one.mismatches)]
        for one in counted
    ]  # fmt: skip
    head = ["scenario", "law", "setting", "worst", "median", "ticks", "words unlike the host's"]
    return titled("instructions a tick on the emulated Cortex-M4", head, rows, (0, 1, 2))


def ruler_table(ruler: Ruler) -> str:
    rows = [
        [
            f"{row['freq_Hz']:g}",
            f"{number(row['own']['amp_pct'], 2)} / {number(row['own']['accel_pct'], 2)}",
            f"{row['published']['amp_pct']:g} / {row['published']['accel_pct']:g}",
            number(row["own"]["balanced_amp_pct"], 2),
            number(row["under_pts"], 2),
        ]
        for row in ruler.own_under()
    ]
    head = ["Hz", "own amp / accel", "table", "own amp, accel >= 0", "under pts"]
    return titled("bounds: own optimal control beside the reference's table", head, rows)
