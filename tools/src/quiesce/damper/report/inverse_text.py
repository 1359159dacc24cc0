"""What the check of an inverse says, as text, numbers, map and plot."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from quiesce.base.atomic import output_files
from quiesce.base.table import format_table
from quiesce.damper.force_map import map_words, top_mA, why_no_map
from quiesce.damper.inverse import (
    STROKE,
    VELOCITY,
    Axis,
    Monotone,
    SteadyForces,
    inverse_map,
    why_no_closed_form,
)
from quiesce.damper.model_file import DamperModel
from quiesce.damper.plain import plain
from quiesce.report.plot_style import pyplot
from quiesce.table.file import table_bytes

FORCES = 41
WHERE = {VELOCITY: "in mid-stroke", STROKE: "where the motion turns"}


def range_text(damper: DamperModel, found: Monotone) -> str:
    top_A, axis = found.forces.currents_A[-1], found.forces.axis.name
    spread = np.ptp(found.forces.force_N, axis=1)
    if spread.max() <= 1e-9 * max(float(np.abs(found.forces.force_N).max()), 1e-300):
        return "the force does not follow the current: there is no inverse"
    if found.is_whole:
        return f"the force rises with the current up to {top_A:g} A at every {axis}"
    if found.limit_A <= 0.0:
        return f"at some {axis} the force falls from 0 A on: there is no inverse there"
    return (
        f"the force rises with the current up to {found.limit_A:.3g} A only; beyond, two currents "
        "give one force: the inverse and the largest command end there"
    )


def form_text(damper: DamperModel) -> str:
    why = why_no_closed_form(damper)
    if why:
        return f"inverse: by interpolation between constant currents (no closed form: {why})"
    return "inverse: in closed form (the force is of 2nd order in the current)"


def map_text(found: Monotone) -> str:
    if why := why_no_map(found):
        return f"no map for a controller: {why}"
    return (
        f"map for a controller: {4 * len(map_words(found))} bytes, 0 .. {top_mA(found) / 1e3:g} A"
    )


def text_of(damper: DamperModel, found: Monotone) -> str:
    forces = found.forces
    force_N = forces.force_N
    rows = zip(forces.places, force_N[:, 0], force_N.max(axis=1), found.per_place_A, strict=True)
    place = f"{forces.axis.name} {forces.axis.unit}||.4g"
    head = [place, "force at 0 A, N||.4g", "largest, N||.4g", "rises up to, A||.3g"]
    range_A = f"0 .. {forces.currents_A[-1]:g} A"
    return "\n".join(
        [
            f"{damper.name} ({damper.model}), {range_A}, {WHERE[forces.axis]}",
            format_table(head, rows, left=()),
            "",
            range_text(damper, found),
            form_text(damper),
            map_text(found),
        ]
    )


def numbers_of(damper: DamperModel, found: Monotone) -> dict:
    return plain(
        {
            "name": damper.name,
            "model": damper.model,
            "monotone_to_A": found.limit_A,
            "is_monotone": found.is_whole,
            "has_closed_form": not why_no_closed_form(damper),
            **named(found),
            "force_at_0_A_N": found.forces.force_N[:, 0],
            "largest_force_N": found.forces.force_N.max(axis=1),
            "why_no_map": why_no_map(found),
        }
    )


def column_of(axis: Axis) -> str:
    return f"{axis.name}_{axis.unit.replace('/', '_')}"


def named(found: Monotone) -> dict:
    if found.forces.axis == STROKE:
        return {"strokes_m": found.forces.places, "per_stroke_A": found.per_place_A}
    return {"velocities_m_s": found.forces.places, "per_velocity_A": found.per_place_A}


def up_to_limit(found: Monotone) -> SteadyForces:
    """The rising part."""
    forces = found.forces
    kept = max(2, int(np.searchsorted(forces.currents_A, found.limit_A * (1.0 + 1e-12), "right")))
    return replace(forces, currents_A=forces.currents_A[:kept], force_N=forces.force_N[:, :kept])


def write_joined(folder: Path, words: Sequence[int], name: str = "map.table") -> None:
    with output_files(folder) as staging:
        (staging / name).write_bytes(table_bytes(words))


def write_map(folder: Path, damper: DamperModel, found: Monotone) -> None:
    rising = up_to_limit(found)
    wanted = np.linspace(0.0, float(rising.force_N.max()), FORCES)
    currents, feasible = inverse_map(rising, wanted)
    column = column_of(found.forces.axis)
    lines = [f"{column},force_N,current_A,feasible"]
    for k, place in enumerate(rising.places):
        side = np.sign(place)
        for j, force in enumerate(wanted):
            cells = (place, side * force, currents[k, j])
            lines.append(",".join(f"{cell:.6g}" for cell in cells) + f",{int(feasible[k, j])}")
    table = [f"{column},current_A,force_N"]
    for place, row in zip(found.forces.places, found.forces.force_N, strict=True):
        for current, force in zip(found.forces.currents_A, row, strict=True):
            table.append(f"{place:.6g},{current:.6g},{np.sign(place) * force:.6g}")
    with output_files(folder) as staging:
        (staging / "inverse.csv").write_text("\n".join([*lines, ""]), encoding="utf-8")
        (staging / "forces.csv").write_text("\n".join([*table, ""]), encoding="utf-8")
        plot_forces(staging / "inverse.svg", damper, found)
        if not why_no_map(found):
            (staging / "map.table").write_bytes(table_bytes(map_words(found)))
    if why_no_map(found):
        # One of a run before must not pass for this damper's.
        (folder / "map.table").unlink(missing_ok=True)


def plot_forces(file: Path, damper: DamperModel, found: Monotone) -> None:
    plt = pyplot()
    figure, axes = plt.subplots(figsize=(8, 4.5))
    forces = found.forces
    shades = plt.get_cmap("viridis")(np.linspace(0.0, 0.85, len(forces.places)))
    for place, row, shade in zip(forces.places, forces.force_N, shades, strict=True):
        label = f"{place:.3g} {forces.axis.unit}"
        axes.plot(forces.currents_A, np.sign(place) * row, color=shade, label=label)
    if not found.is_whole:
        axes.axvline(found.limit_A, color="#222222", lw=0.8, ls="--")
        axes.annotate(f"{found.limit_A:.3g} A", (found.limit_A, 0.0), fontsize=8)
    axes.set(xlabel="coil current (A)", ylabel=f"force {WHERE[forces.axis]} (N)")
    axes.set_title(f"{damper.name}: force over current at constant {forces.axis.name}")
    axes.legend(ncols=2)
    figure.savefig(file, metadata={"Date": None})
    plt.close(figure)
