"""What the check of an inverse says, as text, numbers, map and plot."""

from pathlib import Path

import numpy as np

from quiesce.base.atomic import output_files
from quiesce.base.table import format_table
from quiesce.damper.force_map import map_words, top_mA, why_no_map
from quiesce.damper.inverse import Monotone, SteadyForces, inverse_map, why_no_closed_form
from quiesce.damper.model_file import DamperModel
from quiesce.damper.plain import plain
from quiesce.report.plot_style import pyplot

FORCES = 41


def range_text(damper: DamperModel, found: Monotone) -> str:
    top_A = found.forces.currents_A[-1]
    spread = np.ptp(found.forces.force_N, axis=1)
    if spread.max() <= 1e-9 * max(float(np.abs(found.forces.force_N).max()), 1e-300):
        return "the force does not follow the current: there is no inverse"
    if found.is_whole:
        return f"the force rises with the current up to {top_A:g} A at every velocity"
    if found.limit_A <= 0.0:
        return "at some velocity the force falls from 0 A on: there is no inverse there"
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
    rows = [
        [f"{velocity:.4g}", f"{row[0]:.4g}", f"{row.max():.4g}", f"{limit_A:.3g}"]
        for velocity, row, limit_A in zip(
            forces.velocities_m_s, forces.force_N, found.per_velocity_A, strict=True
        )
    ]
    head = ["velocity m/s", "force at 0 A, N", "largest, N", "rises up to, A"]
    return "\n".join(
        [
            f"{damper.name} ({damper.model}), 0 .. {forces.currents_A[-1]:g} A, mid-stroke",
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
            "velocities_m_s": found.forces.velocities_m_s,
            "per_velocity_A": found.per_velocity_A,
            "force_at_0_A_N": found.forces.force_N[:, 0],
            "largest_force_N": found.forces.force_N.max(axis=1),
            "why_no_map": why_no_map(found),
        }
    )


def up_to_limit(found: Monotone) -> SteadyForces:
    """The rising part."""
    forces = found.forces
    kept = max(2, int(np.searchsorted(forces.currents_A, found.limit_A * (1.0 + 1e-12), "right")))
    return SteadyForces(
        forces.velocities_m_s, forces.currents_A[:kept], forces.force_N[:, :kept]
    )  # fmt: skip


def write_map(folder: Path, damper: DamperModel, found: Monotone) -> None:
    rising = up_to_limit(found)
    wanted = np.linspace(0.0, float(rising.force_N.max()), FORCES)
    currents, feasible = inverse_map(rising, wanted)
    lines = ["velocity_m_s,force_N,current_A,feasible"]
    for k, velocity in enumerate(rising.velocities_m_s):
        side = np.sign(velocity)
        for j, force in enumerate(wanted):
            cells = (velocity, side * force, currents[k, j])
            lines.append(",".join(f"{cell:.6g}" for cell in cells) + f",{int(feasible[k, j])}")
    table = ["velocity_m_s,current_A,force_N"]
    for velocity, row in zip(found.forces.velocities_m_s, found.forces.force_N, strict=True):
        for current, force in zip(found.forces.currents_A, row, strict=True):
            table.append(f"{velocity:.6g},{current:.6g},{np.sign(velocity) * force:.6g}")
    with output_files(folder) as staging:
        (staging / "inverse.csv").write_text("\n".join([*lines, ""]), encoding="utf-8")
        (staging / "forces.csv").write_text("\n".join([*table, ""]), encoding="utf-8")
        plot_forces(staging / "inverse.svg", damper, found)
        if not why_no_map(found):
            words = "".join(f"0x{word:08x}\n" for word in map_words(found))
            (staging / "map.words").write_text(words, encoding="utf-8")
    if why_no_map(found):
        # One of a run before must not pass for this damper's.
        (folder / "map.words").unlink(missing_ok=True)


def plot_forces(file: Path, damper: DamperModel, found: Monotone) -> None:
    plt = pyplot()
    figure, axes = plt.subplots(figsize=(8, 4.5))
    forces = found.forces
    shades = plt.get_cmap("viridis")(np.linspace(0.0, 0.85, len(forces.velocities_m_s)))
    for velocity, row, shade in zip(forces.velocities_m_s, forces.force_N, shades, strict=True):
        label = f"{velocity:.3g} m/s"
        axes.plot(forces.currents_A, np.sign(velocity) * row, color=shade, label=label)
    if not found.is_whole:
        axes.axvline(found.limit_A, color="#222222", lw=0.8, ls="--")
        axes.annotate(f"{found.limit_A:.3g} A", (found.limit_A, 0.0), fontsize=8)
    axes.set(xlabel="coil current (A)", ylabel="force in mid-stroke (N)")
    axes.set_title(f"{damper.name}: force over current at constant velocity")
    axes.legend(ncols=2)
    figure.savefig(file, metadata={"Date": None})
    plt.close(figure)
