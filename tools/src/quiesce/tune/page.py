"""The report of `quiesce tune`: tables as text, and one HTML page that needs nothing beside it."""

from collections.abc import Sequence
from dataclasses import dataclass

from quiesce.base.table import format_table
from quiesce.report.page import render
from quiesce.tune.cycle import Cycle
from quiesce.tune.law import Row, setting_words
from quiesce.tune.phase_table import SETTINGS
from quiesce.tune.robust import Cell

Table = tuple[list[str], list[list[str]]]


@dataclass(frozen=True)
class Tuned:
    """All that a report tells."""

    name: str
    plant: str
    command: str
    first_Hz: float
    rows: list[Row]
    cells: list[Cell]
    cycles: list[Cycle]
    parameters: dict[str, int | str]
    identification: str | None  # its report, where the plant was identified


def pair(found: dict[str, float] | None) -> str:
    if found is None:
        return "-"
    return f"{found['amp_red_pct']:.1f} / {found['accel_red_pct']:.1f}"


def point_table(rows: Sequence[Row]) -> Table:
    head = ["Hz", "bound", "accel>=0", "best constant", "A"]
    head += [column for name in SETTINGS for column in (name, "mean A")]
    out = []
    for row in rows:
        if not row.bounds:
            continue
        best = max(row.constants, key=lambda one: one["amp_red_pct"])
        cells = [f"{row.freq_Hz:g}", f"{row.bounds['amp']['amp_red_pct']:.1f}"]
        cells += [f"{row.bounds['no_worse']['amp_red_pct']:.1f}", pair(best)]
        cells.append(f"{best['current_A']:.2f}")
        for name in SETTINGS:
            found = row.settings[name]
            cells += [pair(found), f"{found['mean_current_A']:.2f}" if found else "-"]
        out.append(cells)
    return head, out


def cell_table(cells: Sequence[Cell]) -> Table:
    head = ["plant", "Hz", "bound", "best constant"]
    head += [f"{name}, table" for name in SETTINGS]
    if any(cell.adapted for cell in cells):
        head += [f"{name}, adapting" for name in SETTINGS]
    return head, [cell_row(cell) for cell in cells]


def cell_row(cell: Cell) -> list[str]:
    row = [cell.variant.name, f"{cell.freq_Hz:g}", f"{cell.bound['amp_red_pct']:.1f}"]
    row.append(pair(cell.constant))
    row += [pair(cell.table[name]) for name in SETTINGS]
    return row + [pair(cell.adapted[name]) for name in SETTINGS if cell.adapted]


def worst_share(cells: Sequence[Cell], is_adapted: bool) -> float | None:
    """Least share of a plant's own displacement bound; None where nothing is known."""
    shares = []
    for cell in cells:
        found = (cell.adapted if is_adapted else cell.table).get("displacement")
        if found and cell.bound["amp_red_pct"] > 0.1:
            shares.append(found["amp_red_pct"] / cell.bound["amp_red_pct"])
    return min(shares, default=None)


def least_fraction(rows: Sequence[Row], setting: str, bound: str) -> tuple[float, float] | None:
    """Least share of a bound's displacement over the table's points, and its frequency."""
    shares = [
        (found["amp_red_pct"] / row.bounds[bound]["amp_red_pct"], row.freq_Hz)
        for row in rows
        if row.bounds and (found := row.settings[setting])
        and row.bounds[bound]["amp_red_pct"] > 0.1
    ]  # fmt: skip
    return min(shares, default=None)


def text(tuned: Tuned) -> str:
    parts = [
        "reductions against 0 A, %: displacement / RMS acceleration, steady state",
        format_table(*point_table(tuned.rows), left=()),
    ]
    if tuned.cells:
        head, rows = cell_table(tuned.cells)
        parts += ["", "plants that it was not tuned for, nothing retuned"]
        parts.append(format_table(head, rows, left=(0,)))
    parts += ["", f"set:       {setting_words(tuned.parameters)}"]
    return "\n".join(parts)


def share_cards(tuned: Tuned) -> list[tuple[str, str]]:
    out = []
    for setting, bound in zip(SETTINGS, ("amp", "no_worse"), strict=True):
        if least := least_fraction(tuned.rows, setting, bound):
            limit = "" if bound == "amp" else " with acceleration no worse than at 0 A"
            what = f"of the displacement bound{limit}, {setting}, least ({least[1]:g} Hz)"
            out.append((f"{least[0]:.3f}", what))
    for is_adapted, what in ((False, "the table alone"), (True, "adapting, after 120 s")):
        if (share := worst_share(tuned.cells, is_adapted)) is not None:
            out.append((f"{share:.2f}", f"of their bound on the other plants: {what}"))
    unlock_A = 1e-3 * float(tuned.parameters["unlock_current_mA"])
    out.append((f"{unlock_A:g} A", "best constant current, while nothing is locked on to"))
    low_mHz, high_mHz, narrow_mA = (
        int(tuned.parameters[f"narrow_{name}"]) for name in ("low_mHz", "high_mHz", "current_mA")
    )
    if high_mHz:
        band = f"{1e-3 * low_mHz:.3g} to {1e-3 * high_mHz:.3g} Hz"
        what = f"instead of that in setting balanced, where the motion is a narrow band in {band}"
        out.append((f"{1e-3 * narrow_mA:g} A", what))
    return out


def make_page(tuned: Tuned, pictures: dict[str, str]) -> str:
    return render(
        "tune/page.html.j2",
        tuned=tuned,
        pictures=pictures,
        cards=share_cards(tuned),
        settings=setting_words(tuned.parameters),
        points=point_table(tuned.rows),
        plants=tuned.cells and cell_table(tuned.cells),
    )
