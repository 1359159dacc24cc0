"""The tables of rigs: each body and each damper, by law."""

from collections.abc import Sequence
from dataclasses import replace

from quiesce.base.table import format_table
from quiesce.engine import laws
from quiesce.hil.rig import RigRow, by_window
from quiesce.hil.table import merge_targets

# What stands in a column: heading, figure, digits.
BODY_COLUMNS = (
    ("RMS um", "disp_rms_um", 1),
    ("red. %", "disp_rms_um_reduction_pct", 1),
    ("peak um", "peak_disp_um", 1),
    ("red. %", "peak_disp_um_reduction_pct", 1),
    ("RMS mm/s2", "accel_rms_mm_s2", 1),
    ("red. %", "accel_rms_mm_s2_reduction_pct", 1),
)
DAMPER_COLUMNS = (
    ("mean A", "mean_current_A", 2),
    ("peak N", "peak_force_N", 2),
    ("more N", "peak_force_more_N", 2),
    ("stroke um", "peak_stroke_um", 1),
)
LEFT = (0, 1, 2)  # of either table: those with words
NOTE = (
    "RMS, peak: of a body's displacement, and RMS of its acceleration; red.: less than with law "
    "off.\nmean: current of a damper's coil; peak: its force, and by how much that is more than "
    "with law off.\n"
    "All of them true values of the simulated plant. on: 'both' where host and the other target "
    "agree to\nevery digit."
)

Table = tuple[list[str], list[list[str]]]  # head, rows


def number(value: float | None, digits: int) -> str:
    return "-" if value is None else f"{value:z.{digits}f}"


def part_table(kind: str, rows: Sequence[RigRow], columns: Sequence[tuple[str, str, int]]) -> Table:
    """Of the bodies or dampers of one window: the laws one below the other for each of them."""
    body = []
    for part in getattr(rows[0], kind):
        for row in rows:
            figures = getattr(row, kind)[part]
            cells = [number(figures[key], digits) for _, key, digits in columns]
            body.append([part, laws.find(row.law).label, row.target, *cells])
    head = [{"bodies": "body", "dampers": "damper"}[kind], "law", "on"]
    return [*head, *(title for title, _, _ in columns)], body


def merged(rows: Sequence[RigRow]) -> list[RigRow]:
    pairs = merge_targets([(row, None) for row in rows], lambda row: replace(row, target=""))
    return [row for row, _ in pairs]


def rig_tables(rows: Sequence[RigRow]) -> list[tuple[str, Table, Table]]:
    """Of each window: its heading, its bodies, its dampers."""
    return [
        (
            heading,
            part_table("bodies", members, BODY_COLUMNS),
            part_table("dampers", members, DAMPER_COLUMNS),
        )
        for heading, members in by_window(merged(rows)).items()
    ]


def rig_text(rows: Sequence[RigRow]) -> str:
    """For a terminal."""
    parts = []
    for heading, bodies, dampers in rig_tables(rows):
        parts += [heading, format_table(*bodies, LEFT), format_table(*dampers, LEFT)]
    return "\n\n".join([*parts, NOTE])
