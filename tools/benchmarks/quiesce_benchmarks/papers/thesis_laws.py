"""The hysteretic model as the thesis fitted it: laws of the current from recordings at one current,
by its differential evolution (800 individuals, 40 generations, F 0.5, CR 0.8) within Table 4.5.

At one current only the laws' sums count. What a set says of other currents is left to chance, and
another seed gives another answer: several are drawn.
"""

from collections.abc import Sequence

import numpy as np
from quiesce.damper.data.record import Record
from quiesce.damper.fit.thesis_de import HYSTERETIC, mutants

from quiesce_benchmarks.papers import thesis_published as published
from quiesce_benchmarks.seeds import generator

# c_a, c_b, k_a, k_b, alpha_a, alpha_b, alpha_c, beta, delta_a, delta_b, f0_a, f0_b.
LOW = np.array([0, -4000, -1e6, 0, -3000, -1e4, -100, -100, 0, 0, -50, -100], float)
HIGH = np.array([6000, 4000, 10, 1000, 3000, 1e5, 100, 100, 1, 1, 50, 100], float)
# Candidates at once: 300 rows each.
_CHUNK = 100


def forces_N(sets: np.ndarray, record: Record) -> np.ndarray:
    """[sets, 12] -> [sets, samples]."""
    at_A = float(record.command[0])
    c, k, f0 = (sets[:, a] * at_A + sets[:, a + 1] for a in (0, 2, 10))
    alpha = sets[:, 4] * at_A**2 + sets[:, 5] * at_A + sets[:, 6]
    delta = sets[:, 8] * at_A + sets[:, 9]
    x, v = record.disp_m, record.velocity_m_s
    z = np.tanh(np.outer(sets[:, 7], v) + np.outer(delta, np.sign(x)))
    return np.outer(c, v) + np.outer(k, x) + alpha[:, None] * z + f0[:, None]


def errors(sets: np.ndarray, record: Record) -> np.ndarray:
    """Eq 4.2, [sets]."""
    chunks = np.array_split(sets, max(1, len(sets) // _CHUNK))
    rest = [np.linalg.norm(forces_N(one, record) - record.force_N, axis=1) for one in chunks]
    return np.concatenate(rest) / np.linalg.norm(record.force_N)


def fitted(record: Record, rng: np.random.Generator) -> np.ndarray:
    """The best set, [12]."""
    sets = LOW + (HIGH - LOW) * rng.random((HYSTERETIC.population, len(LOW)))
    found = errors(sets, record)
    for _ in range(HYSTERETIC.generations):
        trials = np.clip(mutants(sets, HYSTERETIC, rng), LOW, HIGH)
        trial_errors = errors(trials, record)
        is_better = trial_errors <= found
        sets = np.where(is_better[:, None], trials, sets)
        found = np.where(is_better, trial_errors, found)
    return sets[np.argmin(found)]


def drawn(records: Sequence[Record], seed: int, draws: int) -> dict[str, list[list[float]]]:
    """By scenario and draw: error in % by current."""
    out: dict[str, list[list[float]]] = {name: [] for name in "ABCD"}
    middle = published.MIDDLE
    for draw in range(draws):
        sets = np.array(
            [fitted(one, generator(seed, "laws", draw, k)) for k, one in enumerate(records)]
        )
        by_current = 100.0 * np.array([errors(sets, one) for one in records])  # [current, set]
        out["A"].append(np.diag(by_current).tolist())
        out["B"].append(by_current[middle].tolist())
        out["C"].append(by_current[:, middle].tolist())
        out["D"].append(by_current[:, -1].tolist())
    return out


def text_of(found: dict[str, list[list[float]]]) -> str:
    lines = ["hysteretic model by the thesis' search, laws from one current: error %, all draws"]
    for scenario, draws in found.items():
        ranges = [f"{min(each):.3g} .. {max(each):.3g}" for each in zip(*draws, strict=True)]
        lines.append(f"  {scenario}  {'   '.join(ranges)}")
    return "\n".join(lines)
