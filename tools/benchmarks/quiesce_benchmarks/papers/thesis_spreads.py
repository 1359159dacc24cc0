"""From which grid of memberships the thesis started: what Table 4.9 says of the amplitude.

MATLAB's grid starts with even centres over the data's range, neighbours crossing at half height,
and its gradient runs in the units of the inputs, mm and mm/s: velocities hardly move, displacements
do. Printed after training: moderate widths of 1.128 to 1.279 mm, outer centres 2.04 to 2.78 mm from
the middle. Trained here on +-1.5 mm from a start over +-1.5 mm and over +-3 mm.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np
from quiesce.damper.data.record import Record
from quiesce.damper.learned import anfis
from quiesce.damper.learned.anfis import Premises, Settings

STARTS_mm = (1.5, 3.0)
SPEED_mm_s = 2.0 * np.pi * 10.0 * 1.5
MEMBERSHIPS = 3
PRINTED = {
    "moderate_width_mm": (1.128, 1.234, 1.279, 1.215, 1.154, 1.154),
    "outer_centre_mm": (2.228, 2.5925, 2.6915, 2.621, 2.574, 2.569),  # means of both sides
}


def start_of(half_mm: float) -> Premises:
    """[displacement, velocity] in mm and mm/s."""
    unit = Premises.grid(2, MEMBERSHIPS)
    half = np.array([[half_mm], [SPEED_mm_s]])
    return Premises(half * unit.centres, half * unit.widths)


def trained(record: Record, half_mm: float, epochs: int) -> Premises:
    inputs = 1e3 * np.stack([record.disp_m, record.velocity_m_s], axis=1)
    settings = Settings(epochs=epochs, first_step=0.01)
    force = record.force_N / np.abs(record.force_N).max()
    return anfis.hybrid(inputs, force, settings, start=start_of(half_mm))[0]


def spreads(records: Sequence[Record], epochs: int) -> dict[str, Any]:
    """By start: of displacement, the moderate width and the outer centres by current."""
    out: dict[str, Any] = {"printed": {name: list(values) for name, values in PRINTED.items()}}
    for half_mm in STARTS_mm:
        found = [trained(record, half_mm, epochs) for record in records]
        out[f"start +-{half_mm:g} mm"] = {
            "moderate_width_mm": [float(one.widths[0, 1]) for one in found],
            "outer_centre_mm": [
                float(0.5 * (one.centres[0, 2] - one.centres[0, 0])) for one in found
            ],
            "velocity_width_mm_s": [float(one.widths[1, 1]) for one in found],
        }
    return out


def text_of(found: dict[str, Any]) -> str:
    lines = ["Table 4.9, displacement after training, by the range of the start"]
    for start, values in found.items():
        parts = [
            f"{name.replace('_', ' ')} {min(each):.3g} .. {max(each):.3g}"
            for name, each in values.items()
        ]
        lines.append(f"  {start:15s} {', '.join(parts)}")
    return "\n".join(lines)
