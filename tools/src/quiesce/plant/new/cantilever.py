"""A uniform beam, clamped at one end, with a mass at the other: its first bending modes.

With s along the beam, mu the end's mass over the beam's and b a root of

    1 + cos b cosh b + mu b (cos b sinh b - sin b cosh b) = 0

a mode is y(s) = cosh bs - cos bs - r (sinh bs - sin bs), r = (cosh b + cos b)/(sinh b + sin b), at
w = b^2 sqrt(EI / (m L^3)), EI / L^3 = k / 3 with k the static stiffness at the free end.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from quiesce.plant.new.structure import GROUND, Floats, Structure, number, place_lines

MODES = 2
GRID = 2001  # points over which a mode's mass is summed


@dataclass(frozen=True)
class Cantilever:
    mass_kg: float  # of the beam
    end_kg: float  # at its free end
    stiffness_N_m: float  # force at the free end over deflection there
    damping_ratio: float  # of each mode


@dataclass(frozen=True)
class At:
    """Places as parts of the length, 0 at the clamp, 1 at the free end."""

    force: float
    damper: float
    sensor: float


def roots(mu: float) -> list[float]:
    """b of the first modes: one in each stretch of pi."""

    def residual(b: float) -> float:
        # Over cosh b, which overflows nothing here and has no root.
        return 1.0 / np.cosh(b) + np.cos(b) + mu * b * (np.cos(b) * np.tanh(b) - np.sin(b))

    found = []
    for i in range(MODES):
        low, high = i * np.pi + 1e-9, (i + 1) * np.pi
        for _ in range(200):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if residual(middle) * residual(low) > 0 else (low, middle)
        found.append(0.5 * (low + high))
    return found


def shape(b: float, part: Floats | float) -> Floats:
    r = (np.cosh(b) + np.cos(b)) / (np.sinh(b) + np.sin(b))
    x = b * np.asarray(part, float)
    return np.cosh(x) - np.cos(x) - r * (np.sinh(x) - np.sin(x))


def frequencies_Hz(beam: Cantilever) -> list[float]:
    per_s = np.sqrt(beam.stiffness_N_m / (3.0 * beam.mass_kg))
    return [b**2 * per_s / (2.0 * np.pi) for b in roots(beam.end_kg / beam.mass_kg)]


def stiffness_N_m(mass_kg: float, end_kg: float, freq_Hz: float) -> float:
    """For which the first mode is at this frequency."""
    at_1_N_m = frequencies_Hz(Cantilever(mass_kg, end_kg, 1.0, 0.0))[0]
    return (freq_Hz / at_1_N_m) ** 2


def norm_and_participation(beam: Cantilever, b: float) -> tuple[float, float]:
    """What makes a mode's mass 1 kg, and its modal force for 1 m/s2 of the base, in kg^1/2."""
    values, end = shape(b, np.linspace(0.0, 1.0, GRID)), shape(b, 1.0)
    modal_kg = beam.mass_kg * _mean(values**2) + beam.end_kg * end**2
    norm = 1.0 / np.sqrt(modal_kg)
    return norm, norm * (beam.mass_kg * _mean(values) + beam.end_kg * end)


def _mean(values: Floats) -> float:
    """Simpson's rule over 0 .. 1."""
    weights = np.full(len(values), 2.0)
    weights[1::2], weights[0], weights[-1] = 4.0, 1.0, 1.0
    return float(weights @ values) / (3.0 * (len(values) - 1))


def cantilever_structure(beam: Cantilever, at: At, names: Sequence[str]) -> Structure:
    """names: of the place of the sensor, and of the damper's where that is elsewhere."""
    bs, freqs_Hz = roots(beam.end_kg / beam.mass_kg), frequencies_Hz(beam)
    norms = [norm_and_participation(beam, b) for b in bs]

    def shapes(part: float) -> list[float]:
        return [norm * float(shape(b, part)) for b, (norm, _) in zip(bs, norms, strict=True)]

    lines = [
        f"# A beam of {beam.mass_kg:g} kg with {beam.end_kg:g} kg at its end, "
        f"{beam.stiffness_N_m:.4g} N/m there. Shapes are mass-normalised (kg^-1/2).",
        f"# Parts of its length: shaker {at.force:g}, damper {at.damper:g}, sensor {at.sensor:g}.",
        "[structure]",
        'kind = "modes"',
    ]
    columns = zip(
        freqs_Hz, *map(shapes, (at.force, at.damper, at.sensor)), norms, strict=True
    )  # fmt: skip
    for freq_Hz, force, damper, sensor, (_, participation) in columns:
        lines += [
            "",
            "[[structure.mode]]",
            f"freq_Hz = {number(freq_Hz)}",
            f"damping_ratio = {number(beam.damping_ratio)}    # --damping-ratio",
            f"at_force = {number(force)}",
            f"at_damper = {number(damper)}",
            f"at_sensor = {number(sensor)}",
            f"base_participation = {number(participation)}",
        ]
    for name, part in zip(names, (at.sensor, at.damper), strict=False):
        lines += place_lines(name, shapes(part))
    return Structure(
        f"a cantilever of {beam.mass_kg:g} kg", lines, tuple(names), freqs_Hz,
        (names[-1], GROUND), 1.0, (names[0],),
    )  # fmt: skip
