"""The thesis' test, as far as it can be had: the recordings are not published, models of them are.

10 Hz and +-1.5 mm ("3 mm" is from peak to peak: the velocities in Tables 4.10 and 4.16 are those of
1.5 mm), three cycles at each of six currents. The force is the mean of three published models of
the same recording, each weighted by its published error's inverse square: nearer to the recording
than any of them if their errors are independent, and none of the forms that are fitted to it. It
still flatters models of these kinds, so that ours have to be read beside each other, not as the
damper's errors. Noise of 1 % on top; the thesis states none.
"""

import numpy as np
from quiesce.damper.data.record import Record
from quiesce.damper.model_file import DamperModel
from quiesce.damper.simulate import simulator

from quiesce_benchmarks.damper.synthetic import Tones, record_of, with_force
from quiesce_benchmarks.papers import thesis_published as published

CYCLES = 3
RATE_Hz = 1000.0
NOISE_PART = 0.01


def motion(current_A: float) -> Record:
    tone = Tones(*(np.array([v]) for v in (published.FREQ_Hz, published.AMPLITUDE_m, 0.0)))
    samples = round(CYCLES / published.FREQ_Hz * RATE_Hz)
    return record_of(tone, RATE_Hz, samples, current_A)


def sources(column: int) -> dict[str, DamperModel]:
    """Published models of one current's recording, by their key in ERRORS_pct."""
    current_A = published.CURRENTS_A[column]
    return {
        "anfis9": published.file_of(f"anfis9_{current_A:.1f}A"),
        "anfis27": published.file_of("anfis27"),
        "kwok_tanh": published.tanh_at(column, current_A),
    }


def force_N(column: int) -> np.ndarray:
    """The restored recording without noise."""
    record = motion(published.CURRENTS_A[column])
    found = sources(column)
    weights = np.array([published.ERRORS_pct[name]["A"][column] ** -2.0 for name in found])
    forces = np.array([simulator(one)(record) for one in found.values()])
    return weights @ forces / weights.sum()


def recorded(column: int, seed: int) -> Record:
    return with_force(
        motion(published.CURRENTS_A[column]), force_N(column), NOISE_PART, 100 * seed + column
    )


def recordings(seed: int) -> list[Record]:
    return [recorded(column, seed) for column in range(len(published.CURRENTS_A))]
