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
    head = [f"{one.axis.name} {one.axis.unit}||.6g", *(f"{x:g} A||g" for x in one.currents_A)]
    rows = [(place, *row) for place, row in zip(one.places, one.forces_N, strict=True)]
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
        (i, one.leak_q30 / ONE * bank.rate_Hz, 1e-3 * one.limit_um_s, "yes" if one.leads else "no")
        for i, one in enumerate(bank.elements, start=1)
    ]
    head = ["current||g A", "offset||g N", "N per mm||.4g"]
    head += [f"element {i}||.4g" for i, *_ in elements]
    models = [
        (1e-3 * one.current_mA, 1e-3 * one.offset_mN, 1e3 * unit_N * one.spring,
         *(unit_N * np.array(one.weights, dtype=float)))
        for one in bank.models
    ]  # fmt: skip
    return "\n".join(
        [
            title,
            format_table(["element", "leak||.4g 1/s", "limit||g mm/s", "leads"], elements, (0, 3)),
            "N for a mm/s of each element:",
            format_table(head, models, ()),
        ]
    )
