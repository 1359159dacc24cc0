"""Mass and skew of a rig, planted around dampers that are known."""

import numpy as np
from quiesce.base.table import format_table
from quiesce.damper import library
from quiesce.damper.candidates import Choice, parametric_candidates, setting_of
from quiesce.damper.data.record import Record
from quiesce.damper.data.split import Segment, whole
from quiesce.damper.fit.rig_terms import MASS, SKEW
from quiesce.damper.fit_model import RigFit
from quiesce.damper.task import Plan

from quiesce_benchmarks.part import Effort, Measured
from quiesce_benchmarks.seeds import generator

TITLE = "mass and skew of a rig"
FIGURES = (
    ("rig_mass_found_pct", "%", 100.0, "higher"),
    ("rig_false", "1", 0.0, "lower"),
)
WITHIN = 0.2
# A damper of some 400 N, so that up to 4 kg are plausible.
DAMPERS = {
    "normalised_bouc_wen": {
        "c_N_s_m": 900.0,
        "k_N_m": 2000.0,
        "kw_N": 300.0,
        "rho_1_m": 1500.0,
        "sigma": 0.8,
        "n": 1.5,
        "f0_N": 12.0,
    },
    "bingham": {"fc_N": 250.0, "c_N_s_m": 1200.0, "f0_N": 12.0, "eps_m_s": 2e-3},
}
# kg and s; the last is implausible at this force, and must be left out.
RIGS = ((1.5, 0.0), (2.5, 1e-3), (0.0, 0.0), (60.0, 0.0))
NOISE_N = 3.0
_RATE_Hz, _SECONDS = 200.0, 8.0


def measure(effort: Effort) -> Measured:
    names = ["normalised_bouc_wen"] if effort.is_quick else [*DAMPERS]
    rows, found, planted, false = [], 0, 0, 0
    for name in names:
        for mass_kg, skew_s in RIGS:
            segment = recorded(name, mass_kg, skew_s, effort.seed)
            values = fitted(name, segment, effort.seed)
            is_plausible = 0.0 < mass_kg < 0.1 * np.abs(segment.record.force_N).max() / 9.81
            planted += is_plausible
            found += is_plausible and abs(values.get(MASS, 0.0) / mass_kg - 1.0) <= WITHIN
            false += MASS in values and not is_plausible
            false += SKEW in values and skew_s == 0.0
            told = [f"{values[key]:.4g}" if key in values else "-" for key in (MASS, SKEW)]
            rows.append([name, f"{mass_kg:g}", f"{skew_s:g}", *told])
    head = ["damper", "planted kg", "planted s", "found kg", "found s"]
    return Measured(
        {"rig_mass_found_pct": 100.0 * found / planted, "rig_false": float(false)},
        tables=(format_table(head, rows, left=(0,)),),
    )


def recorded(name: str, mass_kg: float, skew_s: float, seed: int) -> Segment:
    """Three sines at once, 4 mm at 1 Hz and in inverse proportion above, as a rig records them."""
    time_s = np.arange(round(_SECONDS * _RATE_Hz)) / _RATE_Hz
    freqs_Hz = np.array([[1.0], [3.1], [7.3]])
    omega, size_m = 2.0 * np.pi * freqs_Hz, 4e-3 / freqs_Hz
    motion = (
        np.sum(size_m * np.sin(omega * time_s), axis=0),
        np.sum(size_m * omega * np.cos(omega * time_s), axis=0),
        -np.sum(size_m * omega**2 * np.sin(omega * time_s), axis=0),
    )
    zero = np.zeros(len(time_s))
    still = Record("made", _RATE_Hz, time_s, *motion, zero, zero, "A")
    truth, model = DAMPERS[name], library.model(name)
    rig = [{MASS: mass_kg, SKEW: skew_s}.get(one, 0.0) for one in library.RIG]
    row = np.array([*(truth[one.name] for one in model.parameters), *rig])
    orders = [1] * len(model.parameters)
    force_N = library.simulate(model, orders, row, library.motion(still), 8)[0]
    force_N += generator(seed, name, mass_kg, skew_s).normal(0.0, NOISE_N, len(force_N))
    return whole(Record("made", _RATE_Hz, time_s, *motion, force_N, zero, "A"))


def fitted(name: str, segment: Segment, seed: int) -> dict[str, float]:
    """By variable, terms of the rig that were taken in among them."""
    candidate, choice = parametric_candidates()[name], Choice()
    plan = Plan([name], choice, seed, quick=True)
    fit = RigFit(candidate, [segment], plan, None, 1e6, lambda *_: None)
    problem, found, _ = fit.with_rig(setting_of(candidate, [segment], choice))
    names = [one.name for one in problem.variables]
    return dict(zip(names, map(float, found.values), strict=True))
