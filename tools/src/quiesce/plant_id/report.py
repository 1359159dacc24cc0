"""What was identified, how sure it is, what was assumed, and what is wrong with the data."""

import math
from typing import Any

import numpy as np

from quiesce.base.paths import shown
from quiesce.base.table import format_table
from quiesce.plant_id.fit import DwellModel, Fit, is_linear
from quiesce.plant_id.plant_file import ASSUMED_DAMPER_KEYS, Base
from quiesce.plant_id.recording import SweepRecording

# 95 % of a normal distribution.
SIGMAS = 1.96
# A parameter whose standard error exceeds this part of it was not really identified.
WEAK_PART = 0.2
# Misfit, as a multiple of the noise and as a part of the signal, from which the model is doubted.
DOUBTED_NOISE = 2.0
DOUBTED_PART = 0.05

UNITS = {
    "_freq_Hz": "Hz",
    "_residue_m_s2_V": "m/s2/V",
    "corner_Hz": "Hz",
    "delay_ms": "ms",
    "_A_N_s_m": "N s/m/A",
    "_N_s_m": "N s/m",
    "_force_N": "N",
    "_velocity_m_s": "m/s",
    "_s": "s",
}


def unit_of(name: str) -> str:
    return next((unit for ending, unit in UNITS.items() if name.endswith(ending)), "")


def interval(name: str, value: float, error: float) -> tuple[float, float]:
    """95 % of the normal distribution that the fit found, on the scale of the parameter."""
    if is_linear(name):
        return value - SIGMAS * error, value + SIGMAS * error
    # Beyond this factor the parameter is unknown; the bound keeps the numbers finite.
    factor = math.exp(min(SIGMAS * error, 50.0))
    return tuple(sorted((value / factor, value * factor)))  # type: ignore[return-value]


def judged(name: str, value: float, error: float) -> str:
    if not math.isfinite(error):
        return "not identified"
    if name == "base_N_s_m":
        error /= max(abs(value), 1e-300)
    limit = WEAK_PART if not name.endswith("_phase_rad") else math.inf
    return "weak" if error > limit else "measured"


def row(name: str, value: float, error: float) -> dict[str, Any]:
    if math.isnan(error):
        return {"name": name, "value": value, "unit": unit_of(name), "status": "assumed"}
    low, high = interval(name, value, error)
    return {
        "name": name,
        "value": value,
        "unit": unit_of(name),
        "low_95": low,
        "high_95": high,
        "status": judged(name, value, error),
    }


def rows(base: Base, fit: Fit) -> list[dict[str, Any]]:
    """Every parameter, and the damper's force and yield velocity, which mean more."""
    table = [
        row(name, value, fit.error(name))
        for name, value in fit.values.items()
        if name != "noise_mg" and not name.endswith("_phase_rad")
    ]
    if "force_scale" in fit.values:
        force_N = base.yield_force_N(fit.values["force_scale"])
        table.append(row("yield_force_N", force_N, fit.error("force_scale")))
        speed = base.yield_velocity_m_s(fit.values["viscosity_ratio"])
        table.append(row("yield_velocity_m_s", speed, fit.error("viscosity_ratio")))
    table.append(row("noise_mg", fit.values["noise_mg"], math.nan) | {"status": "measured"})
    return table


def dwell_misfits(dwell: DwellModel, fit: Fit) -> list[tuple[float, float, float]]:
    """Of each dwell: frequency, misfit over noise, misfit over signal."""
    found = []
    for number, one in enumerate(dwell.dwells):
        rest = float(np.sqrt(np.mean(dwell.residual(number, fit.values) ** 2)))
        signal = float(dwell.measured(number).std()) / dwell.recording.noise_m_s2
        found.append((one.freq_Hz, rest, math.sqrt(max(0.0, rest**2 - 1.0)) / max(signal, 1e-9)))
    return found


def fit_warnings(recording: SweepRecording, base: Base, dwell: DwellModel, fit: Fit) -> list[str]:
    found = []
    for freq_Hz, noise, part in dwell_misfits(dwell, fit):
        if noise > DOUBTED_NOISE and part > DOUBTED_PART:
            found.append(
                f"{freq_Hz:.4g} Hz: {100.0 * part:.0f} % of the vibration is not explained "
                f"({noise:.3g} x noise): {base.model} does not describe this damper"
            )
    if fit.misfit > DOUBTED_NOISE and not found:
        found.append(
            f"the fit leaves {fit.misfit:.3g} times the sensor's noise; intervals are widened"
        )
    for name in fit.names:
        if judged(name, fit.values[name], fit.error(name)) != "measured":
            found.append(f"{name} is not well known: see its interval")
    if "force_scale" in fit.values and "force_scale" not in fit.names:
        found.append(f"damper and coil lag are those of {shown(base.file)}: none were measured")
    peak = float(np.abs(recording.drive_V).max())
    if peak > 0.0 and fit.values["mode1_damping_ratio"] < 1e-4:
        found.append("mode 1 is nearly undamped; sweep longer to measure its damping")
    return found


def assumed_lines(base: Base) -> list[str]:
    where = "at the sensor" if base.is_damper_at_sensor else "elsewhere, its shapes fitted"
    lines = [
        f"modal mass of mode 1 at the sensor: {base.modal_mass_kg:g} kg. Forces scale with it; "
        "displacements, accelerations and reductions do not",
        f"the damper acts {where}",
        f"sensor range and bits, driver range and bits: {shown(base.file)}",
    ]
    if base.model == "viscous":
        return lines
    keys = ", ".join(ASSUMED_DAMPER_KEYS)
    return [
        *lines,
        f"tied: {keys} and the yield stress at {base.ref_current_A:g} A ({base.yield_Pa:.4g} Pa) "
        f"are those of {shown(base.file)}; the recording tells force_scale (the force) and "
        "viscosity_ratio (the velocity at which it yields) for them",
    ]


def formatted_rows(table: list[dict[str, Any]]) -> str:
    cells = [
        (
            one["name"], one["value"],
            f"{one['low_95']:.6g} .. {one['high_95']:.6g}" if "low_95" in one else "",
            one["unit"], one["status"],
        )
        for one in table
    ]  # fmt: skip
    head = ["parameter", "value||.6g", "95 % interval", "unit", ""]
    return format_table(head, cells, left=(0, 3, 4))


def text_report(
    recording: SweepRecording,
    base: Base,
    fit: Fit,
    table: list[dict[str, Any]],
    warnings: list[str],
) -> str:
    dwells = ", ".join(f"{one.freq_Hz:.4g}" for one in recording.dwells) or "none"
    lines = [
        f"recording  {shown(recording.file)}: {len(recording.accel_m_s2)} samples at "
        f"{recording.rate_Hz} Hz; {len(recording.sweeps)} sweep(s); dwells at {dwells} Hz",
        f"misfit     {fit.misfit:.3f} of the sensor's noise (1: nothing is left but noise)",
        "",
        formatted_rows(table),
        "",
        "Assumed, since drive and acceleration cannot tell:",
        *(f"- {line}" for line in assumed_lines(base)),
    ]
    if warnings:
        lines += ["", "Warnings:", *(f"- {warning}" for warning in warnings)]
    return "\n".join(lines)


def head_lines(recording: SweepRecording, base: Base) -> list[str]:
    """Comments at the head of the plant file."""
    return [
        f"Identified from {recording.file.name} by 'quiesce sweep --identify'. Assumed:",
        *(f"- {line}" for line in assumed_lines(base)),
    ]


def key_notes(base: Base, fit: Fit) -> dict[str, str]:
    """Comments beside the keys of the plant file."""
    keys = {
        "structure.mode{}.freq_Hz": "mode{}_freq_Hz",
        "structure.mode{}.damping_ratio": "mode{}_damping_ratio",
    }
    count = sum(1 for name in fit.values if name.endswith("_freq_Hz"))
    notes = {
        key.format(i): error_note(name.format(i), fit)
        for i in range(1, count + 1)
        for key, name in keys.items()
    }
    for key, name in {
        "damper.force_scale": "force_scale",
        "damper.viscosity_ratio": "viscosity_ratio",
        "damper.yield_exponent": "yield_exponent",
        "damper.per_A_N_s_m": "per_A_N_s_m",
        "damper.base_N_s_m": "base_N_s_m",
        "coil.rise_s": "rise_s",
        "coil.fall_s": "fall_s",
        "shaker.gain_N_V": "mode1_residue_m_s2_V",
        "shaker.corner_Hz": "corner_Hz",
    }.items():
        if name in fit.values:
            notes[key] = error_note(name, fit)
    return notes | {f"damper.{key}": "assumed" for key in ASSUMED_DAMPER_KEYS}


def error_note(name: str, fit: Fit) -> str:
    error = fit.error(name)
    if math.isnan(error):
        return "assumed"
    if is_linear(name):
        return f"+- {SIGMAS * error:.2g}"
    return f"+- {100.0 * SIGMAS * error:.2g} %" if error < 1.0 else "not identified"
