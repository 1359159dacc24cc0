"""A plant from a recording: it is read, fitted, judged; plant file and report."""

import json
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from quiesce.base.atomic import output_files
from quiesce.base.paths import default_plant
from quiesce.base.progress import say
from quiesce.plant.library import Plant
from quiesce.plant_id.fit import DwellModel, Fit, best_damper, fit_all, modes_of, start_values
from quiesce.plant_id.modes import SweepModel, find_modes
from quiesce.plant_id.plant_file import Base, plant_table, plant_text, read_base
from quiesce.plant_id.plots import plot_dwells, plot_sweep
from quiesce.plant_id.recording import SweepRecording, has_steps, read_sweep_recording
from quiesce.plant_id.report import fit_warnings, head_lines, key_notes, rows, text_report
from quiesce.plant_id.simulate import GRAVITY_m_s2

PLANT_NAME = "plant.toml"


@dataclass(frozen=True)
class FoundPlant:
    """plant_file: what the recording says, in the schema of plant files."""

    plant_file: Path
    report_file: Path
    fit: Fit
    base: Base
    recording: SweepRecording
    warnings: list[str]
    text: str


def fitted(
    recording: SweepRecording, base: Base, mode_count: int | None, tell: Callable[[str], None]
) -> tuple[SweepModel, DwellModel, Fit]:
    """The models of both parts and the fit of everything that the recording can tell."""
    sweep = SweepModel(recording, base.ref_freq_Hz)
    modes = find_modes(sweep, mode_count, tell)
    dwell = DwellModel(recording, recording.dwells, base)
    start = start_values(dwell, modes, 1e3 * recording.noise_m_s2 / GRAVITY_m_s2)
    fixed = {"noise_mg"}
    if any(has_steps(recording, one) for one in recording.dwells):
        tell("damper: trial values")
        start = best_damper(dwell, modes, start)
    else:
        carried = carried_over(base)
        start |= carried
        fixed |= {*carried, *(name for name in start if name.endswith("_ratio") and "mode" in name)}
        fixed -= {name for name in fixed if name.endswith("_damping_ratio")}
    tell("least squares over the whole recording")
    return sweep, dwell, fit_all(sweep, dwell, start, [n for n in start if n not in fixed])


def carried_over(base: Base) -> dict[str, float]:
    """Damper and lag of the base plant, for a recording that tells neither."""
    plant = Plant(base.file)
    scale = plant.modes[0].at_damper ** 2 * base.modal_mass_kg
    lag = {"rise_s": plant.rise_s, "fall_s": plant.fall_s}
    if base.model == "viscous":
        # What resists without current is in the damping that the sweep shows.
        per_A = scale * base.damper["per_A_N_s_m"]
        return {**lag, "per_A_N_s_m": per_A, "base_N_s_m": 0.0}
    return {
        **lag,
        "force_scale": scale * float(base.damper.get("force_scale", 1.0)),
        "viscosity_ratio": float(base.damper["viscosity_ratio"]),
        "yield_exponent": float(base.damper.get("yield_exponent", 1.0)),
    }


def find_plant(
    recording_file: Path,
    out: Path,
    base_file: Path | None = None,
    modal_mass_kg: float = 1.0,
    is_damper_at_sensor: bool = True,
    mode_count: int | None = None,
    tell: Callable[[str], None] = say,
) -> FoundPlant:
    """Writes plant.toml, report.txt, identify.json and plots into `out`.

    base_file: a plant file for what no recording can tell (sensor, driver, damper model and
    geometry). mode_count: modes in the swept band, found where None. UsageError
    for a recording that cannot be used; nothing is written then.
    """
    base_file = base_file or default_plant()
    Plant(base_file)
    recording = read_sweep_recording(recording_file)
    largest_A = float(recording.current_A.max())
    base = read_base(base_file, modal_mass_kg, largest_A, is_damper_at_sensor)
    sweep, dwell, fit = fitted(recording, base, mode_count, tell)
    warnings = recording.warnings + fit_warnings(recording, base, dwell, fit)
    table = rows(base, fit)
    text = text_report(recording, base, fit, table, warnings)
    drive_V = max((one.amplitude_V for one in recording.dwells), default=0.0)
    drive_V = drive_V or float(abs(recording.drive_V).max())
    plant = plant_table(base, fit.values, recording_file.stem, drive_V)
    figures = {"misfit": fit.misfit, "parameters": table, "warnings": warnings}
    with output_files(out) as staging:
        notes = key_notes(base, fit)
        staged = staging / PLANT_NAME
        staged.write_text(plant_text(plant, head_lines(recording, base), notes), encoding="utf-8")
        Plant(staged)
        (staging / "report.txt").write_text(text + "\n", encoding="utf-8")
        (staging / "identify.json").write_text(json.dumps(figures, indent=1) + "\n")
        plot_sweep(staging / "sweep.png", sweep, modes_of(fit.values, base))
        if recording.dwells:
            plot_dwells(staging / "dwells.png", dwell, fit)
    return FoundPlant(out / PLANT_NAME, out / "report.txt", fit, base, recording, warnings, text)
