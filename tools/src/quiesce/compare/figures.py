"""Figures of one run, from the true motion that the bench records."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from quiesce.compare.weighting import velocity_rms_mm_s, vibration_dose, weighted
from quiesce.compare.zones import machines
from quiesce.engine.trace import Trace

# Name, unit, what it is; in this order in every table.
FIGURES = (
    ("disp_peak_mm", "mm", "peak displacement of the last body"),
    ("disp_rms_mm", "mm", "its RMS"),
    ("drift_peak_mm", "mm", "largest displacement between neighbours, the base below the first"),
    ("drift_rms_mm", "mm", "largest RMS of that"),
    ("accel_peak_m_s2", "m/s2", "largest peak of an absolute acceleration, of all bodies"),
    ("accel_rms_m_s2", "m/s2", "largest RMS of one"),
    ("force_peak_N", "N", "largest force of a damper"),
    ("current_mean_A", "A", "mean current of all dampers"),
    ("current_rms_A", "A", "RMS current of all dampers"),
    ("chatter_A_s", "A/s", "total variation of a damper's current a second, the largest"),
    ("dissipated_J", "J", "what the dampers took in"),
    ("weighted_m_s2", "m/s2", "RMS of the last body's acceleration, weighted by Wk of ISO 2631-1"),
    ("vdv_m_s175", "m/s^1.75", "vibration dose of that"),
    ("velocity_rms_mm_s", "mm/s", "largest RMS velocity of a body, 10 .. 1000 Hz"),
)
# Of plants with a tyre or another contact that lifts off.
OF_CONTACTS = (
    ("tyre_share", "-", "RMS of what a contact's load varies by, over its load at rest; the worst"),
    ("lift_pct", "%", "of the time without contact, the worst"),
    ("rattle_mm", "mm", "largest peak of a damper's stroke"),
)
ALL_FIGURES = (*FIGURES, *OF_CONTACTS)
# Ratios of these to those of all current make the index: response, drift, acceleration.
INDEXED = (
    "disp_peak_mm", "disp_rms_mm", "drift_peak_mm", "drift_rms_mm", "accel_peak_m_s2",
    "accel_rms_m_s2",
)  # fmt: skip

Figures = dict[str, float]


@dataclass(frozen=True)
class Contact:
    """Between a body and the moving base: it carries preload_N at rest and never pulls."""

    body: str
    stiffness_N_m: float
    damping_N_s_m: float
    preload_N: float


def columns(bodies: Sequence[str], dampers: Sequence[str]) -> list[str]:
    """What `figures_of` reads of a trace."""
    names = ["t_s"]
    for body in bodies:
        names += [f"{body}_true_um", f"{body}_true_mm_s2"]
    for damper in dampers:
        names += [f"{damper}_true_{what}" for what in ("stroke_um", "force_mN", "mA")]
        names.append(f"{damper}_current_cmd_mA")
    return names


def figures_of(
    trace: Trace,
    bodies: Sequence[str],
    dampers: Sequence[str],
    contacts: Sequence[Contact] = (),
) -> Figures:
    time_s = trace["t_s"]
    rate_Hz = (len(time_s) - 1) / (time_s[-1] - time_s[0])
    places = np.array([1e-3 * trace[f"{name}_true_um"] for name in bodies])
    accels = np.array([1e-3 * trace[f"{name}_true_mm_s2"] for name in bodies])
    drifts = np.diff(places, axis=0, prepend=0.0)
    currents = np.array([1e-3 * trace[f"{name}_true_mA"] for name in dampers])
    commands = np.array([1e-3 * trace[f"{name}_current_cmd_mA"] for name in dampers])
    forces = np.array([1e-3 * trace[f"{name}_true_force_mN"] for name in dampers])
    strokes = np.array([1e-6 * trace[f"{name}_true_stroke_um"] for name in dampers])
    felt = weighted(accels[-1], rate_Hz)
    duration_s = time_s[-1] - time_s[0]
    of_contacts = _of_contacts(trace, contacts, strokes) if contacts else {}
    return {
        "disp_peak_mm": _peak(places[-1]),
        "disp_rms_mm": _rms(places[-1]),
        "drift_peak_mm": max(map(_peak, drifts)),
        "drift_rms_mm": max(map(_rms, drifts)),
        "accel_peak_m_s2": max(map(_peak, accels)),
        "accel_rms_m_s2": max(map(_rms, accels)),
        "force_peak_N": _peak(forces),
        "current_mean_A": float(currents.mean()),
        "current_rms_A": _rms(currents),
        "chatter_A_s": float(np.abs(np.diff(commands, axis=1)).sum(axis=1).max() / duration_s),
        "dissipated_J": _work_J(forces, strokes),
        "weighted_m_s2": _rms(felt),
        "vdv_m_s175": vibration_dose(felt, rate_Hz),
        "velocity_rms_mm_s": max(velocity_rms_mm_s(one, rate_Hz) for one in accels),
        **of_contacts,
    }


def _of_contacts(trace: Trace, contacts: Sequence[Contact], strokes: np.ndarray) -> Figures:
    """The base's motion is the road's: a body's own is what the contact is pressed by."""
    varied, lifted = [], []
    for one in contacts:
        way_m = 1e-6 * trace[f"{one.body}_true_um"]
        speed_m_s = np.gradient(way_m, trace["t_s"])
        load_N = np.minimum(
            one.stiffness_N_m * way_m + one.damping_N_s_m * speed_m_s, one.preload_N
        )
        varied.append(_rms(load_N - load_N.mean()) / one.preload_N)
        lifted.append(100.0 * float(np.mean(load_N >= one.preload_N)))
    return {
        "tyre_share": max(varied),
        "lift_pct": max(lifted),
        "rattle_mm": 1e3 * _peak(strokes),
    }


def zone_of(figures: Figures) -> str:
    """Of ISO 20816-3, machines of 15 to 300 kW on a stiff foundation."""
    return machines()["medium:rigid"].zone(figures["velocity_rms_mm_s"])


def index(figures: Figures, all_current: Figures) -> float:
    """Mean of six ratios to all current: below 1 is better than that."""
    return float(np.mean([figures[name] / all_current[name] for name in INDEXED]))


def _peak(values: np.ndarray) -> float:
    return float(np.abs(values).max())


def _rms(values: np.ndarray) -> float:
    return float(np.sqrt(np.mean(values**2)))


def _work_J(forces: np.ndarray, strokes: np.ndarray) -> float:
    """By trapezoids over the stroke: forces resist strokes that grow."""
    mean = 0.5 * (forces[:, 1:] + forces[:, :-1])
    return float((mean * np.diff(strokes, axis=1)).sum())
