"""The magnetorheological elastomer (MRD+MRE paper, eqs 25 to 31, Figs 5 to 7) beside ours."""

import tempfile
import tomllib
from pathlib import Path

import numpy as np
import tomli_w
from numpy.typing import NDArray
from quiesce.base.paths import root
from quiesce.base.table import format_table
from quiesce.optimum.periodic import drive, solve
from quiesce.plant.library import Plant
from quiesce.plant.variant import read_plant_data
from quiesce.report.plot_style import pyplot, svg_of

from quiesce_benchmarks.papers import elastomer_mount as mount
from quiesce_benchmarks.papers.elastomer_mount import Bode
from quiesce_benchmarks.part import Effort, Measured

TITLE = "elastomer: stiffness, damping and the Bode figure of 5 kg"
FIGURES = (
    ("elastomer_area_diff_pct", "%", 0.5, "lower"),
    ("elastomer_stiffness_diff_pct", "%", 0.5, "lower"),
    ("elastomer_bode_diff_pct", "%", 0.5, "lower"),
    ("elastomer_one_setting_diff_pct", "%", None, "lower"),
)

Floats = NDArray[np.float64]
PLANT = Path("sim_hil/data/plants/elastomer_mount.toml")
CURRENTS_A = (0.0, 0.5, 1.0, 1.5, 2.0)
BAND_Hz = (20.0, 90.0)
# Table 1: peak acceleration, m/s2, and the measure E: uncontrolled, damper, damper and elastomer.
TABLE_1 = {
    "10 Hz": ((10.13, 5.34), (3.21, 2.56), (2.67, 1.69)),
    "40 Hz": ((19.5, 9.25), (6.94, 4.32), (6.31, 2.92)),
    "not periodic": ((29.6, 10.25), (12.9, 4.83), (9.26, 3.58)),
}


def stiffness_N_m(plant: Plant, current_A: float) -> float:
    """Of the simulated mount: force over displacement far below its resonance, the mass's part
    taken off."""
    freq_Hz = 2.0
    orbit = solve(drive(plant, freq_Hz), current_A)
    force_N = plant.drive_V * plant.shaker_per_V(freq_Hz)
    dynamic = force_N / orbit.disp_fundamental_m * np.exp(1j * np.radians(-orbit.disp_phase_deg))
    # F = drive sin(theta), x = X cos(theta + phase): turned by a quarter.
    spring = dynamic * np.exp(-0.5j * np.pi) + mount.MASS_kg * (2.0 * np.pi * freq_Hz) ** 2
    return float(spring.real)


def plant_at(folder: Path, freq_Hz: float) -> Plant:
    """The mount with its loss factor taken at this frequency (eq 30: d = loss k / w)."""
    data = read_plant_data(root() / PLANT)
    data["damper"]["parameters"]["loss_freq_Hz"] = freq_Hz
    file = folder / f"mount_{freq_Hz:.3f}Hz.toml"
    file.write_text(tomli_w.dumps(data), encoding="utf-8")
    return Plant(file)


def gain_m_N(plant: Plant, current_A: float, freq_Hz: float) -> float:
    """Receptance of the simulated mount: displacement per force."""
    orbit = solve(drive(plant, freq_Hz), current_A)
    return orbit.disp_fundamental_m / (plant.drive_V * plant.shaker_per_V(freq_Hz))


def stiffness_table(found: dict[float, float], base_MPa: float) -> str:
    """Eqs 29 to 31; K(i) read as newtons a metre, as printed, would not be seen."""
    head = ["i A", "K(i)", "k as printed N/m", "k, K in MPa, N/m", "simulated N/m"]
    per_MPa = 1e6 * mount.PUBLISHED_AREA_m2 / mount.THICKNESS_m
    rows = [
        [
            f"{current_A:g}",
            f"{mount.rise(current_A):.4f}",
            f"{mount.PUBLISHED_N_m[0] + mount.rise(current_A):.1f}",
            f"{(base_MPa + mount.rise(current_A)) * per_MPa:.4g}",
            f"{found[current_A]:.4g}",
        ]
        for current_A in CURRENTS_A
    ]
    return format_table(head, rows)


def size_table(base_MPa: float) -> str:
    """What eqs 25, 26 and 29 print, and what comes out of them."""
    per_MPa = 1e6 * mount.area_m2() / mount.THICKNESS_m
    rings = [np.pi * (outer**2 - inner**2) for inner, outer in mount.RADII_mm]
    rows = [
        ["area of both rings, mm2", f"{1e6 * mount.PUBLISHED_AREA_m2:.0f}",
         f"{1e6 * mount.area_m2():.2f}"],
        ["rings, mm2 (said to be equal)", "-", f"{rings[0]:.2f}, {rings[1]:.2f}"],
        ["least stiffness, N/m", f"{mount.PUBLISHED_N_m[0]:.3g}", f"{base_MPa * per_MPa:.4g}"],
        ["current of most stiffness, A", "-", f"{mount.current_of_most_A(base_MPa):.2f}"],
    ]  # fmt: skip
    return format_table(["eqs 25 to 29", "published", "ours"], rows)


def diff_pct(gains: Floats, exact: Bode, freqs_Hz: Floats) -> float:
    """The largest of the band."""
    return float(100.0 * np.abs(gains / np.abs(exact.receptance_m_N(freqs_Hz)) - 1.0).max())


def bode(plants: dict[float, Plant], exact: Bode, current_A: float) -> dict[str, float]:
    """Simulated mount beside the closed form: with its damping set to each frequency of the
    figure, as eq 30 says, and set once, to the natural frequency, as a run in time needs it."""
    freqs_Hz = np.array(list(plants))
    set_Hz = min(plants, key=lambda freq_Hz: abs(freq_Hz - exact.natural_Hz))
    each = np.array([gain_m_N(plant, current_A, freq_Hz) for freq_Hz, plant in plants.items()])
    once = np.array([gain_m_N(plants[set_Hz], current_A, freq_Hz) for freq_Hz in freqs_Hz])
    peak = np.abs(exact.transmissibility(np.array([exact.natural_Hz])))
    return {
        "current_A": current_A,
        "natural_Hz": exact.natural_Hz,
        "peak_Hz": float(freqs_Hz[np.argmax(each)]),
        "diff_pct": diff_pct(each, exact, freqs_Hz),
        "once_peak_Hz": float(freqs_Hz[np.argmax(once)]),
        "once_diff_pct": diff_pct(once, exact, freqs_Hz),
        "transmissibility": float(peak[0]),
    }


def bode_table(rows: list[dict[str, float]]) -> str:
    head = ["i A", "natural Hz", "peak Hz, eq 30", "worst %", "peak Hz, set once", "worst %",
            "transmissibility"]  # fmt: skip
    cells = [
        [
            f"{row['current_A']:g}",
            f"{row['natural_Hz']:.2f}",
            f"{row['peak_Hz']:.1f}",
            f"{row['diff_pct']:.3f}",
            f"{row['once_peak_Hz']:.1f}",
            f"{row['once_diff_pct']:.2f}",
            f"{row['transmissibility']:.2f}",
        ]
        for row in rows
    ]
    return format_table(head, cells)


def table_1() -> str:
    """Published ratios. E over peak would be the same number in a row of steady sines: it is not,
    so peaks and E cannot both hold."""
    head = ["Table 1, published", "peak: damper", "and elastomer", "E: damper", "and elastomer",
            "E/peak: open", "damper", "both"]  # fmt: skip
    rows = []
    for name, (free, damper, both) in TABLE_1.items():
        ratios = [one[i] / free[i] for i in (0, 1) for one in (damper, both)]
        shares = [e / peak for peak, e in (free, damper, both)]
        rows.append([name, *(f"{value:.2f}" for value in ratios + shares)])
    return format_table(head, rows)


def plot(folder: Path, stiffness: dict[float, float], loss_factor: float) -> None:
    """Fig 7: transmissibility of 5 kg on the mount."""
    figure, axes = pyplot().subplots(2, 1, figsize=(7, 6), sharex=True)
    freqs = np.geomspace(10.0, 200.0, 600)
    for current_A, k_N_m in stiffness.items():
        found = Bode(k_N_m, loss_factor).transmissibility(freqs)
        axes[0].semilogx(freqs, 20.0 * np.log10(np.abs(found)), label=f"{current_A:g} A")
        axes[1].semilogx(freqs, np.degrees(np.angle(found)))
    axes[0].set(ylabel="magnitude (dB)", title="5 kg on the elastomer, loss factor 0.2")
    axes[1].set(ylabel="phase (deg)", xlabel="frequency (Hz)")
    axes[0].legend()
    (folder / "elastomer_bode.svg").write_text(svg_of(figure), encoding="utf-8")


def measure(effort: Effort) -> Measured:
    file = root() / PLANT
    plant, data = Plant(file), tomllib.loads(file.read_text(encoding="utf-8"))
    damper = tomllib.loads((file.parent / data["damper"]["file"]).read_text(encoding="utf-8"))
    parameters = damper["parameters"]
    base_MPa, loss_factor = parameters["storage_MPa"][0], parameters["loss_factor"]
    stiffness = {current_A: stiffness_N_m(plant, current_A) for current_A in CURRENTS_A}
    step_Hz = 2.5 if effort.is_quick else 0.5
    freqs_Hz = np.arange(BAND_Hz[0], BAND_Hz[1] + step_Hz / 2, step_Hz)
    with tempfile.TemporaryDirectory() as folder:
        plants = {float(freq_Hz): plant_at(Path(folder), freq_Hz) for freq_Hz in freqs_Hz}
    rows = [
        bode(plants, Bode(k_N_m, loss_factor), current_A) for current_A, k_N_m in stiffness.items()
    ]
    plot(effort.folder, stiffness, loss_factor)
    most_A = mount.current_of_most_A(base_MPa)
    ends = (stiffness[0.0], stiffness_N_m(plant, most_A))
    diffs = [abs(k / want - 1.0) for k, want in zip(ends, mount.PUBLISHED_N_m, strict=True)]
    values = {
        "elastomer_area_diff_pct": 100.0 * abs(mount.area_m2() / mount.PUBLISHED_AREA_m2 - 1.0),
        "elastomer_stiffness_diff_pct": 100.0 * max(diffs),
        "elastomer_bode_diff_pct": max(row["diff_pct"] for row in rows),
        "elastomer_one_setting_diff_pct": max(row["once_diff_pct"] for row in rows),
    }
    reported = {
        "stiffness_N_m": {f"{current_A:g}A": k_N_m for current_A, k_N_m in stiffness.items()},
        "most_A": most_A,
        "bode": rows,
    }
    tables = (size_table(base_MPa), stiffness_table(stiffness, base_MPa), bode_table(rows))
    return Measured(values, reported, (*tables, table_1()))
