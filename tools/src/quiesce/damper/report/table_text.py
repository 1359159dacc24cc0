"""Tables of trackers in words: maps and banks."""

from collections.abc import Sequence

import numpy as np

from quiesce.base.table import format_table
from quiesce.damper.bank.table import ONE, Bank
from quiesce.damper.force_map import Map


def described_maps(maps: Sequence[Map]) -> str:
    """A section each: forces over places and currents."""
    return "\n\n".join(_map(i, one) for i, one in enumerate(maps))


def _map(damper: int, one: Map) -> str:
    head = [f"{one.axis.name} {one.axis.unit}", *(f"{x:g} A" for x in one.currents_A)]
    rows = [
        [f"{place:.6g}", *(f"{force:g}" for force in row)]
        for place, row in zip(one.places, one.forces_N, strict=True)
    ]
    title = f"damper {damper + 1}: force in N over {one.axis.name}, 0 .. {one.currents_A[-1]:g} A"
    return f"{title}\n{format_table(head, rows, ())}"


def described_banks(banks: Sequence[Bank]) -> str:
    return "\n\n".join(_bank(i, one) for i, one in enumerate(banks))


def _bank(damper: int, bank: Bank) -> str:
    title = (
        f"damper {damper + 1}: {len(bank.elements)} elements at {len(bank.models)} currents, 0 .. "
        f"{bank.currents_A[-1]:g} A, for {bank.rate_Hz} ticks a second"
    )
    # Of an element a mm/s long, of a stroke of a mm.
    unit_N = 2.0**-bank.shift
    elements = [
        [str(i + 1), f"{one.leak_q30 / ONE * bank.rate_Hz:.4g} 1/s",
         f"{1e-3 * one.limit_um_s:g} mm/s", "yes" if one.leads else "no"]
        for i, one in enumerate(bank.elements)
    ]  # fmt: skip
    head = ["current", "offset", "N per mm", *(f"element {i + 1}" for i in range(len(elements)))]
    models = [
        [f"{1e-3 * one.current_mA:g} A", f"{1e-3 * one.offset_mN:g} N",
         f"{1e3 * unit_N * one.spring:.4g}",
         *(f"{unit_N * weight:.4g}" for weight in np.array(one.weights, dtype=float))]
        for one in bank.models
    ]  # fmt: skip
    return "\n".join(
        [
            title,
            format_table(["element", "leak", "limit", "leads"], elements, (0, 3)),
            "N for a mm/s of each element:",
            format_table(head, models, ()),
        ]
    )
