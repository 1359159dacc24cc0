"""What a user says of a structure, and the plan of files that follows from it."""

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from quiesce.base.errors import UsageError
from quiesce.plant.new import cantilever, chain
from quiesce.plant.new.drive import read_drive, steps_Hz
from quiesce.plant.new.parts import read_damper, read_sensor
from quiesce.plant.new.structure import GROUND, Structure
from quiesce.plant.new.text import Plan

NAME = re.compile(r"[A-Za-z][A-Za-z0-9_]{0,31}")  # of plants, boards and what is on them


@dataclass(frozen=True)
class Order:
    """As typed; None: not given."""

    name: str
    command: str
    masses_kg: Sequence[float]
    stiffness_N_m: Sequence[float] | None
    freq_Hz: float | None
    damping_ratio: float
    bodies: Sequence[str] | None
    is_cantilever: bool
    end_kg: float | None
    damper: str
    damper_at: str | None
    lever: float | None
    max_current: float | None
    drive: str
    drive_at: str | None
    accel: str | None
    accel_at: Sequence[str] | None
    range_g: float | None
    bits: int
    folder: Path
    is_forced: bool


def make_plan(order: Order, range_g: float) -> Plan:
    """UsageError where what was said contradicts itself, naming the option. range_g: of the
    accelerometer."""
    require_name("NAME", order.name)
    structure = cantilever_of(order) if order.is_cantilever else chain_of(order)
    drive = read_drive(order.drive)
    if drive.kind != "force" and order.drive_at is not None:
        raise UsageError(
            f"--drive-at {order.drive_at}: the base has one place; it goes with force:"
        )
    return Plan(
        name=order.name,
        command=order.command,
        structure=structure,
        damping_ratio=order.damping_ratio,
        damper=read_damper(order.damper, order.max_current),
        sensor=None if order.accel is None else read_sensor(order.accel),
        drive=drive,
        freqs_Hz=steps_Hz(drive, structure.freqs_Hz),
        range_g=range_g,
        bits=order.bits,
        max_step_us=None,
    )


def with_step(plan: Plan, max_step_us: float | None) -> Plan:
    return replace(plan, max_step_us=max_step_us)


def require_name(option: str, name: str) -> None:
    if NAME.fullmatch(name) is None:
        raise UsageError(
            f"{option} {name}: expected a letter, then at most 31 letters, digits or _"
        )


def body_names(order: Order, count: int, usual: str) -> list[str]:
    names = list(order.bodies or [])
    if not names:
        names = [usual] if count == 1 else [f"{usual}{i + 1}" for i in range(count)]
    if len(names) != count:
        raise UsageError(f"--bodies: {len(names)} names for {count} bodies")
    for name in names:
        require_name("--bodies", name)
        if name in (GROUND, "damper") or names.count(name) > 1:
            raise UsageError(f"--bodies {name}: expected names that differ, not {GROUND} or damper")
    return names


def chain_of(order: Order) -> Structure:
    count = len(order.masses_kg)
    if count > chain.MOST_BODIES:
        raise UsageError(f"--mass: {count} bodies; a plant has at most {chain.MOST_BODIES} places")
    if order.end_kg is not None:
        raise UsageError("--end-mass goes with --cantilever")
    names = body_names(order, count, "mass")
    one = chain.Chain(order.masses_kg, springs_of(order), order.damping_ratio, names)
    return chain.chain_structure(
        one,
        force_at=order.drive_at or names[0],
        sensors=order.accel_at or names[:1],
        damper_at=order.damper_at or names[0],
        lever=1.0 if order.lever is None else order.lever,
    )


def springs_of(order: Order) -> Sequence[float]:
    if (order.stiffness_N_m is None) == (order.freq_Hz is None):
        raise UsageError(
            "give --stiffness or --freq, one of them: with the mass each tells the other"
        )
    if order.stiffness_N_m is None:
        if len(order.masses_kg) > 1:
            raise UsageError(
                "--freq: of one body; for several give --stiffness, a spring below each"
            )
        assert order.freq_Hz is not None
        return [chain.own_frequency_N_m(order.masses_kg[0], order.freq_Hz)]
    if len(order.stiffness_N_m) != len(order.masses_kg):
        raise UsageError(
            f"--mass has {len(order.masses_kg)} bodies, --stiffness {len(order.stiffness_N_m)} "
            "springs; expected one below each body, from the top down"
        )
    return order.stiffness_N_m


def cantilever_of(order: Order) -> Structure:
    if len(order.masses_kg) != 1:
        raise UsageError(
            "--cantilever: --mass is the beam's, one number; --end-mass what is at its end"
        )
    if order.lever is not None:
        raise UsageError("--lever goes with bodies on springs, not with --cantilever")
    end_kg = order.end_kg or 0.0
    if (order.stiffness_N_m is None) == (order.freq_Hz is None):
        raise UsageError("give --stiffness (static, at the free end) or --freq, one of them")
    if order.stiffness_N_m is not None and len(order.stiffness_N_m) != 1:
        raise UsageError("--cantilever: --stiffness is one number, the static one at the free end")
    stiffness_N_m = (
        order.stiffness_N_m[0] if order.stiffness_N_m is not None
        else cantilever.stiffness_N_m(order.masses_kg[0], end_kg, order.freq_Hz or 1.0)
    )  # fmt: skip
    at = cantilever.At(
        part_of("--drive-at", order.drive_at),
        part_of("--damper-at", order.damper_at),
        part_of("--accel-at", order.accel_at[0] if order.accel_at else None),
    )
    if order.accel_at and len(order.accel_at) > 1:
        raise UsageError("--accel-at: one accelerometer on a cantilever")
    names = ["end"] if at.sensor == at.damper else ["sensor", "grip"]
    names = body_names(order, len(names), "") if order.bodies else names
    beam = cantilever.Cantilever(order.masses_kg[0], end_kg, stiffness_N_m, order.damping_ratio)
    return cantilever.cantilever_structure(beam, at, names)


def part_of(option: str, text: str | None) -> float:
    """Of the beam's length; its free end where nothing is said."""
    try:
        part = 1.0 if text is None else float(text)
    except ValueError:
        part = -1.0
    if not 0.0 < part <= 1.0:
        raise UsageError(
            f"{option} {text}: on a cantilever expected a part of its length, above 0 to 1"
        )
    return part
