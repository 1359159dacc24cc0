"""A recording of a damper that is known, to try identification on: made by the library itself."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from quiesce.damper.data.record import Record
from quiesce.damper.model_file import DamperModel
from quiesce.damper.simulate import simulator

# The truth. Coefficients against the current in A, ascending.
EXAMPLE = DamperModel(
    name="example damper",
    model="normalised_bouc_wen",
    stroke_m=0.02,
    speed_m_s=0.3,
    parameters={
        "c_N_s_m": [550.0, 900.0],
        "k_N_m": 1500.0,
        "kw_N": [60.0, 820.0, -180.0],
        "rho_1_m": 900.0,
        "sigma": 0.8,
        "n": 1.6,
        "f0_N": 12.0,
    },
    rig={"rise_s": 0.012, "fall_s": 0.02},
    source={"text": "made up for the example"},
    valid={"current_A": [0.0, 1.0]},
)
LEVELS_A = (0.0, 0.5, 1.0)


@dataclass(frozen=True)
class Recipe:
    """How the example was recorded."""

    duration_s: float = 24.0
    dwell_s: float = 2.0  # at each current, then the next of LEVELS_A
    rate_Hz: float = 200.0
    fine: int = 10  # steps of the simulation a row
    amplitude_m: float = 8e-3
    noise_part: float = 0.01  # deviation of the force's noise over its RMS
    resolution_m: float = 1e-6
    seed: int = 6


# Frequencies in Hz, parts of the amplitude and phases of the motion.
_TONES = ((0.7, 0.55, 0.0), (1.9, 0.3, 1.1), (4.3, 0.12, 2.7), (7.1, 0.05, 0.4))


def example_motion(recipe: Recipe) -> Record:
    """Sum of sines, current in steps; without a force."""
    rate_Hz = recipe.rate_Hz * recipe.fine
    time_s = np.arange(round(recipe.duration_s * rate_Hz)) / rate_Hz
    disp, velocity, accel = (np.zeros(len(time_s)) for _ in range(3))
    for freq_Hz, part, phase in _TONES:
        w = 2.0 * np.pi * freq_Hz
        size = recipe.amplitude_m * part
        disp += size * np.sin(w * time_s + phase)
        velocity += size * w * np.cos(w * time_s + phase)
        accel -= size * w**2 * np.sin(w * time_s + phase)
    # The current changes from one row to the next, in a straight line.
    row_s = time_s[:: recipe.fine]
    block = (row_s / recipe.dwell_s + 1e-9).astype(int)
    current_A = np.interp(time_s, row_s, np.array(LEVELS_A)[block % len(LEVELS_A)])
    zero = np.zeros(len(time_s))
    return Record("example", rate_Hz, time_s, disp, velocity, accel, zero, current_A, "A")


def example_columns(recipe: Recipe | None = None) -> dict[str, np.ndarray]:
    """The example's columns by name, as a rig would record them: noise and rounding included."""
    recipe = recipe or Recipe()
    fine = example_motion(recipe)
    force_N = simulator(EXAMPLE)(fine)
    rng = np.random.default_rng(recipe.seed)
    deviation_N = recipe.noise_part * float(np.sqrt(np.mean(force_N**2)))
    rows = slice(None, None, recipe.fine)
    noise_N = deviation_N * rng.standard_normal(len(fine.time_s[rows]))
    return {
        "time_s": fine.time_s[rows],
        "disp_mm": 1e3 * recipe.resolution_m * np.round(fine.disp_m[rows] / recipe.resolution_m),
        "force_N": force_N[rows] + noise_N,
        "current_A": fine.command[rows],
    }


def example_text(recipe: Recipe | None = None) -> str:
    """The example as CSV."""
    columns = example_columns(recipe)
    rows = zip(*columns.values(), strict=True)
    lines = [f"{t:.3f},{x:.3f},{force:.2f},{current:g}" for t, x, force, current in rows]
    return "\n".join([",".join(columns), *lines, ""])


def write_example(file: Path, recipe: Recipe | None = None) -> None:
    """Writes the CSV file and, beside it, the damper that it came from (FILE_truth.toml)."""
    from quiesce.base.atomic import output_files

    text, truth = example_text(recipe), EXAMPLE.to_toml()
    with output_files(file.parent) as staging:
        (staging / file.name).write_text(text, encoding="utf-8")
        (staging / truth_file(file).name).write_text(truth, encoding="utf-8")


def truth_file(file: Path) -> Path:
    return file.with_name(f"{file.stem}_truth.toml")
