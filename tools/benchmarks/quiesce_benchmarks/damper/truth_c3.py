"""The step-by-step least squares for Bouc-Wen on a known damper, beside the reference's numbers."""

import numpy as np
from quiesce.base.table import format_table
from quiesce.damper import library
from quiesce.damper.data.record import Record
from quiesce.damper.fit.least_squares_bouc_wen import BoucWenFit, Sines, fit

from quiesce_benchmarks.damper.synthetic import Tones, force_of, record_of, row_of, with_force

TRUTH = BoucWenFit(
    current=0.0, c_N_s_m=2500.0, k_N_m=6000.0, A_N_m=1.6e6, beta=10.87, gamma=25.37, n=1.6, f0_N=0.0
)
AMPLITUDE_m = 0.005
SHIFT_m = 0.002
RATE_Hz = 2000.0
CYCLES = 11
SUBSTEPS = 16
# Noise over the RMS of the force, and what the reference found (beta, gamma, n).
LEVELS = (
    (0.0, None),
    (0.002, {"beta": 11.1, "gamma": 26.2, "n": 1.595}),
    (0.01, {"beta": 10.2, "gamma": 24.5, "n": 1.606}),
)
NAMES = ("c_N_s_m", "k_N_m", "A_N_m", "beta", "gamma", "n")


def sine_record(freq_Hz: float, shift_m: float, noise_part: float, seed: int) -> Record:
    tones = Tones(np.array([freq_Hz]), np.array([AMPLITUDE_m]), np.array([0.0]))
    one = library.model("bouc_wen")
    known = TRUTH.bouc_wen()
    record = record_of(tones, RATE_Hz, round(CYCLES * RATE_Hz / freq_Hz) + 1, TRUTH.current)
    # The shift is added to the displacement that is recorded: the force of k stands for it.
    row = row_of(one, [known[parameter.name] for parameter in one.parameters])
    force_N = force_of(one, row, record, SUBSTEPS) + TRUTH.k_N_m * shift_m
    record.disp_m[:] += shift_m
    return with_force(record, force_N, noise_part, seed)


def fit_at(noise_part: float, seed: int) -> BoucWenFit:
    return fit(
        Sines(
            sine_record(1.0, 0.0, noise_part, 3 * seed),
            sine_record(1.0, SHIFT_m, noise_part, 3 * seed + 1),
            sine_record(2.0, 0.0, noise_part, 3 * seed + 2),
        )
    )


def table(seeds: int) -> tuple[str, float]:
    """Medians over the seeds beside the reference, and the largest deviation without noise, %."""
    rows = [["truth", *(f"{getattr(TRUTH, name):.5g}" for name in NAMES)]]
    worst_pct = 0.0
    for noise_part, reference in LEVELS:
        fits = [fit_at(noise_part, seed) for seed in range(seeds if noise_part else 1)]
        values = {name: float(np.median([getattr(one, name) for one in fits])) for name in NAMES}
        rows.append([f"{100.0 * noise_part:g} % noise", *(f"{values[name]:.5g}" for name in NAMES)])
        if reference is not None:
            cells = [f"{reference[name]:.5g}" if name in reference else "" for name in NAMES]
            rows.append(["  reference", *cells])
        else:
            rows.append(["  reference", *["within 0.2 %"] * len(NAMES)])
            errors = [abs(values[name] / getattr(TRUTH, name) - 1.0) for name in NAMES]
            worst_pct = 100.0 * max(errors)
    text = f"least-squares Bouc-Wen, three sines; medians of {seeds} seeds"
    return f"{text}\n{format_table(['', *NAMES], rows)}", worst_pct
