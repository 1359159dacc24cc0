"""Bodies on springs, one on the other down to the ground: a mount, storeys, a quarter car."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from quiesce.base.errors import UsageError
from quiesce.base.nearest import listed
from quiesce.plant.new.structure import GROUND, Floats, Structure, place_lines, row

MOST_BODIES = 4


@dataclass(frozen=True)
class Chain:
    """From the top body down to the one that stands on the ground."""

    masses_kg: Sequence[float]
    stiffness_N_m: Sequence[float]  # of the spring below each
    damping_ratio: float  # of each mode
    names: Sequence[str]


def own_frequency_N_m(mass_kg: float, freq_Hz: float) -> float:
    """Of the spring below one mass."""
    return mass_kg * (2.0 * np.pi * freq_Hz) ** 2


def matrices(chain: Chain) -> tuple[Floats, Floats, Floats, Floats]:
    """Mass, damping and stiffness; natural frequencies in Hz, ascending."""
    count = len(chain.masses_kg)
    mass = np.diag(np.asarray(chain.masses_kg, float))
    stiffness = np.zeros((count, count))
    for i, spring_N_m in enumerate(chain.stiffness_N_m):
        ends = np.eye(count)[i] - (np.eye(count)[i + 1] if i + 1 < count else 0.0)
        stiffness += spring_N_m * np.outer(ends, ends)
    root = np.sqrt(np.diag(mass))
    squares, turns = np.linalg.eigh(stiffness / np.outer(root, root))
    omega = np.sqrt(squares)
    # Of modes v: M v diag(2 zeta w) v' M, with v = M^-1/2 turns.
    scaled = root[:, None] * turns
    damping = scaled @ np.diag(2.0 * chain.damping_ratio * omega) @ scaled.T
    return mass, damping, stiffness, omega / (2.0 * np.pi)


def chain_structure(
    chain: Chain, *, force_at: str, sensors: Sequence[str], damper_at: str, lever: float
) -> Structure:
    """damper_at: BODY, towards what is below it, or BODY:OTHER. UsageError names the option."""
    names = list(chain.names)
    ends = damper_ends(names, damper_at)
    for name in sensors:
        index_of(names, name, "--accel-at")
    units = np.eye(len(names))
    force = units[index_of(names, force_at, "--drive-at")]
    stroke = sum(
        sign * units[names.index(end)] for sign, end in zip((1, -1), ends, strict=True)
        if end != GROUND
    )  # fmt: skip
    mass, damping, stiffness, freqs_Hz = matrices(chain)
    lines = [
        f"# Coordinates: {', '.join(names)}; displacements relative to the ground, which may move.",
        "[structure]",
        'kind = "matrices"',
        *matrix_lines("mass_kg", mass, "--mass"),
        *matrix_lines("damping_N_s_m", damping, f"{chain.damping_ratio:g} of each mode"),
        *matrix_lines("stiffness_N_m", stiffness, "--stiffness, or --freq: the springs' own"),
        f"force = {row(force)}    # where the shaker pushes: {force_at}",
        f"damper = {row(stroke)}    # its ends: {' less '.join(ends)}",
        f"sensor = {row(units[names.index(sensors[0])])}    # the accelerometer: {sensors[0]}",
    ]
    for name, unit in zip(names, units, strict=True):
        lines += place_lines(name, unit)
    masses = " over ".join(f"{mass_kg:g}" for mass_kg in chain.masses_kg)
    return Structure(
        f"{masses} kg", lines, tuple(names), list(freqs_Hz), ends, lever, tuple(sensors)
    )


def matrix_lines(name: str, matrix: Floats, note: str) -> list[str]:
    return [f"{name} = [    # {note}", *(f"    {row(one)}," for one in matrix), "]"]


def index_of(names: Sequence[str], name: str, option: str) -> int:
    if name not in names:
        raise UsageError(f"{option} {name}: no such body; {listed(name, names)}")
    return list(names).index(name)


def damper_ends(names: Sequence[str], text: str) -> tuple[str, str]:
    first, colon, other = text.partition(":")
    at = index_of(names, first, "--damper-at")
    if not colon:
        other = names[at + 1] if at + 1 < len(names) else GROUND
    if other != GROUND:
        index_of(names, other, "--damper-at")
    if other == first:
        raise UsageError(f"--damper-at {text}: both ends are on {first}")
    return first, other
