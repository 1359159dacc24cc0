"""The cantilever's modes (squeeze-mode paper, eqs 20 to 24, Fig 6, Table VI) beside ours."""

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from quiesce.base.paths import root
from quiesce.base.table import format_table
from quiesce.optimum.periodic import drive, solve
from quiesce.plant.library import Plant
from quiesce.plant.variant import read_plant_data

from quiesce_benchmarks.papers import modes_beam
from quiesce_benchmarks.part import Effort, Measured

TITLE = "modes: frequencies of Table VI, shapes of eq 24"
# The plant file states the published frequencies: here its response has to peak there.
FIGURES = (
    ("mode1_freq_diff_pct", "%", 1.0, "lower"),
    ("mode2_freq_diff_pct", "%", 1.0, "lower"),
    ("mode_orthogonality_printed", "-", None, "lower"),
    ("mode_orthogonality_corrected", "-", 0.1, "lower"),
)

Floats = NDArray[np.float64]
PLANT = Path("sim_hil/data/plants/squeeze_2012_nodes.toml")
PUBLISHED_Hz = (11.5, 96.0)  # Table VI: measured; the simulated column is lost
BANDWIDTH_Hz = (1.73, 2.76)  # 2 xi f, of the damping matrix
NODE_MASS_kg = (9.72e-3, 9.72e-3, 9.72e-3, 9.72e-3, 30e-3)  # shaft in parts of 60 mm, disc
SPAN = 0.12  # of a published frequency, on each side


def printed(shapes: Floats) -> Floats:
    """As eq 24 prints them: all positive."""
    return np.abs(shapes)


def orthogonality(shapes: Floats) -> float:
    """Cosine between both shapes, weighted by the lumped masses: 0 for modes of one structure."""
    gram = shapes.T @ np.diag(NODE_MASS_kg) @ shapes
    return float(gram[0, 1] / np.sqrt(gram[0, 0] * gram[1, 1]))


def likeness(a: Floats, b: Floats) -> float:
    """Modal assurance criterion, 0 .. 1."""
    return float((a @ b) ** 2 / ((a @ a) * (b @ b)))


def response_m_N(plant: Plant, freq_Hz: float) -> float:
    """Displacement at the sensor per force, without current."""
    orbit = solve(drive(plant, freq_Hz), 0.0)
    return orbit.disp_fundamental_m / (plant.drive_V * plant.shaker_per_V(freq_Hz))


def peak(plant: Plant, near_Hz: float, points: int) -> tuple[float, float]:
    """Of the highest response near here: frequency and half-power bandwidth (eqs 22, 23), Hz."""
    freqs = near_Hz * np.linspace(1.0 - SPAN, 1.0 + SPAN, points)
    gain = np.array([response_m_N(plant, freq_Hz) for freq_Hz in freqs])
    top = int(np.clip(np.argmax(gain), 1, points - 2))
    a, b, c = np.polyfit(freqs[top - 1 : top + 2] - freqs[top], gain[top - 1 : top + 2], 2)
    half = (c - b * b / (4.0 * a)) / np.sqrt(2.0)
    low = np.interp(half, gain[: top + 1], freqs[: top + 1])
    high = np.interp(-half, -gain[top:], freqs[top:])
    return float(freqs[top] - b / (2.0 * a)), float(high - low)


def frequency_table(peaks: list[tuple[float, float]], beam_Hz: Floats) -> str:
    head = ["mode", "Table VI Hz", "ours Hz", "diff %", "band publ. Hz", "ours", "beam elements Hz"]
    rows = [
        [
            str(i + 1),
            f"{published:g}",
            f"{freq_Hz:.2f}",
            f"{100 * (freq_Hz / published - 1):+.2f}",
            f"{BANDWIDTH_Hz[i]:g}",
            f"{band_Hz:.2f}",
            f"{beam_Hz[i]:.1f}",
        ]
        for i, (published, (freq_Hz, band_Hz)) in enumerate(zip(PUBLISHED_Hz, peaks, strict=True))
    ]
    return format_table(head, rows)


def shape_table(shapes: Floats, beam: Floats) -> str:
    head = ["kg^-1/2", "mode 1, eq 24", "ours", "beam", "mode 2, eq 24", "ours", "beam"]
    rows = [
        [f"node {node + 1}"]
        + [f"{one[node, mode]:.4f}" for mode in (0, 1) for one in (printed(shapes), shapes, beam)]
        for node in range(len(shapes))
    ]
    return format_table(head, rows)


def sign_table(shapes: Floats, beam: Floats) -> str:
    head = ["second shape", "cosine to the first", "likeness to the beam's (MAC)"]
    rows = [
        [name, f"{orthogonality(one):+.3f}", f"{likeness(one[:, 1], beam[:, 1]):.3f}"]
        for name, one in (
            ("as printed", printed(shapes)),
            ("node 5 negative", shapes),
            ("beam elements", beam),
        )
    ]
    return format_table(head, rows)


def shapes_of(plant: Path) -> Floats:
    """[node x mode] of a plant file with nodes."""
    modes = read_plant_data(plant)["structure"]["mode"]
    return np.array([mode["shape"] for mode in modes], dtype=float).T


def measure(effort: Effort) -> Measured:
    file = root() / PLANT
    plant, shapes = Plant(file), shapes_of(file)
    points = 33 if effort.is_quick else 97
    peaks = [peak(plant, freq_Hz, points) for freq_Hz in PUBLISHED_Hz]
    beam_Hz, beam = modes_beam.modes(len(shapes), len(PUBLISHED_Hz))
    diffs = [
        100.0 * abs(freq_Hz / published - 1.0)
        for published, (freq_Hz, _) in zip(PUBLISHED_Hz, peaks, strict=True)
    ]
    values = {
        "mode1_freq_diff_pct": diffs[0],
        "mode2_freq_diff_pct": diffs[1],
        "mode_orthogonality_printed": abs(orthogonality(printed(shapes))),
        "mode_orthogonality_corrected": abs(orthogonality(shapes)),
    }
    reported: dict[str, Any] = {
        "freq_Hz": [freq_Hz for freq_Hz, _ in peaks],
        "band_Hz": [band_Hz for _, band_Hz in peaks],
        "beam_Hz": beam_Hz.tolist(),
        "mac_printed": likeness(printed(shapes)[:, 1], beam[:, 1]),
        "mac_corrected": likeness(shapes[:, 1], beam[:, 1]),
    }
    tables = (
        frequency_table(peaks, beam_Hz),
        shape_table(shapes, beam),
        sign_table(shapes, beam),
    )
    return Measured(values, reported, tables)
