"""The text of the files: what a reader of a plant, a board and a scenario has to know."""

import math
from dataclasses import dataclass

from quiesce.plant.new.drive import BASE, Drive
from quiesce.plant.new.parts import DamperPart, SensorPart
from quiesce.plant.new.structure import Structure, number

PLANT, BOARD, STEPS, RANDOM = "plant.toml", "board.toml", "steps.toml", "random.toml"
DAMPER, SENSOR = "damper.toml", "sensor.toml"
ONLY = "damper"  # the name of a plant's only damper
NOISE_mg = 0.5  # of an accelerometer of which nothing is known
UM_S2_PER_G = 9_806_650.0
RANDOM_s = 30.0
LEAST_SETTLE_s, MOST_SETTLE_s, DECAYS = 6.0, 30.0, 3.0
LEAST_MEASURE_s, MEASURED_CYCLES = 2.0, 6.0
HINT = "docs/howto/describe-a-plant.md has every key; docs/howto/own-plant.md says what to do next."


@dataclass(frozen=True)
class Plan:
    """All that the files say."""

    name: str
    command: str  # as it was typed
    structure: Structure
    damping_ratio: float
    damper: DamperPart
    sensor: SensorPart | None
    drive: Drive
    freqs_Hz: list[float]  # of the steps
    range_g: float
    bits: int
    max_step_us: float | None  # None: the default does

    @property
    def settle_s(self) -> float:
        """Until a step is steady without current: so many decay times of the slowest mode."""
        own_Hz = min(self.structure.freqs_Hz)
        decay_per_s = 2.0 * math.pi * own_Hz * self.damping_ratio
        wanted_s = DECAYS / decay_per_s if decay_per_s > 0.0 else MOST_SETTLE_s
        return float(math.ceil(min(max(wanted_s, LEAST_SETTLE_s), MOST_SETTLE_s)))

    @property
    def measure_s(self) -> float:
        return float(math.ceil(max(LEAST_MEASURE_s, MEASURED_CYCLES / min(self.freqs_Hz))))


def head(plan: Plan, schema: str, name: str, what: str) -> list[str]:
    return [
        f"# {what}",
        f"# Made by: {plan.command}",
        f'schema = "{schema}"',
        "version = 1",
        f'name = "{name}"',
    ]


def plant_text(plan: Plan) -> str:
    own = ", ".join(f"{freq_Hz:.4g}" for freq_Hz in plan.structure.freqs_Hz)
    lines = head(
        plan, "quiesce-plant", plan.name, f"{plan.structure.what}, {own} Hz without the damper."
    )
    lines += [f"# {HINT}", "", *plan.structure.lines, "", *damper_lines(plan), "", *shaker(plan)]
    lines += ["", *sensor_lines(plan)]
    if plan.max_step_us is not None:
        lines += [
            "",
            "[integration]",
            f"max_step_us = {plan.max_step_us:g}    # as its damper needs",
        ]
    return "\n".join(lines) + "\n"


def damper_lines(plan: Plan) -> list[str]:
    part = plan.damper
    unit = "V: its file's commands are voltages" if part.is_in_volts else "A"
    lines = [f"# {part.name}: the model and its numbers are in {DAMPER}, a copy.", "[damper]",
             f'file = "{DAMPER}"']  # fmt: skip
    lines += ['command_unit = "V"'] if part.is_in_volts else []
    if plan.structure.lever != 1.0:
        lines += [f"ratio = {number(plan.structure.lever)}    # --lever: of its ends' motion"]
    lines += [
        "",
        "[driver]",
        f"max_current_A = {number(part.max_current)}    # {unit}; {part.current_note}",
        "bits = 12                # steps from 0 to that; assumed",
    ]
    if not part.has_own_coil:
        lines += [
            "",
            "[coil]",
            f"rise_s = {number(part.lag_s)}           # time constant; assumed, its file says none",
        ]
    return lines


def shaker(plan: Plan) -> list[str]:
    drive = plan.drive
    is_base = drive.kind == BASE
    what = "The base moves" if is_base else "A force acts"
    key = "gain_m_s2_V" if is_base else "gain_N_V"
    return [
        f"# {what}, a sine of {drive.level:g} {drive.unit} (--drive {drive.text}): 1 V is that.",
        "[shaker]",
        f"{key} = {number(drive.level)}",
        "drive_V = 1.0",
    ]


def sensor_lines(plan: Plan) -> list[str]:
    lines = [
        f"# Of a scenario without a board. +-{plan.range_g:g} g: see {BOARD}.",
        "[sensor]",
        f"full_scale_g = {number(plan.range_g)}",
        f"bits = {plan.bits}",
    ]
    names = [f"{body}_accel" for body in plan.structure.sensors]
    if plan.sensor is None:
        lines += [f"noise_mg = {NOISE_mg}    # RMS a sample; assumed, no --accel was named", "",
                  "[noise]    # of the board's, in um/s2"]  # fmt: skip
        noise = number(1e-3 * NOISE_mg * UM_S2_PER_G)
        return lines + [f"{name} = {noise}    # {NOISE_mg} mg" for name in names]
    lines += [f'file = "{SENSOR}"    # {plan.sensor.name}']
    for name in names:
        lines += ["", f"[sensors.{name}]", f'file = "{SENSOR}"']
    return lines


def board_text(plan: Plan) -> str:
    structure = plan.structure
    names = ", ".join(f'"{body}"' for body in structure.bodies)
    lines = head(plan, "quiesce-board", plan.name, f"What is wired to what on {plan.name}.")
    lines += [
        "# docs/reference/boards.md has every key.",
        f"bodies = [{names}]    # as places in {PLANT}",
        f'tracked = "{structure.sensors[0]}_accel"    # its frequency and RMS are what laws see',
    ]
    for body in structure.sensors:
        lines += ["", *board_sensor(plan, body)]
    return "\n".join([*lines, "", *board_damper(plan)]) + "\n"


def board_sensor(plan: Plan, body: str) -> list[str]:
    counts = 2 ** (plan.bits - 1)
    scale = round(plan.range_g * UM_S2_PER_G / counts, 3)
    lines = [
        "[[sensor]]",
        f'name = "{body}_accel"',
        'measures = "acceleration"',
        f'of = "{body}"',
        f"scale_um_s2 = {number(scale)}    # {plan.bits} bits over +-{plan.range_g:g} g, at least "
        "twice the peak at 0 A",
        f"full_scale_counts = {counts - 1}",
    ]
    corner_mHz = round(1e3 * plan.sensor.corner_Hz) if plan.sensor else 0
    lines += [f"corner_mHz = {corner_mHz}    # its high-pass, of {SENSOR}"] if corner_mHz else []
    return lines


def board_damper(plan: Plan) -> list[str]:
    first, other = plan.structure.damper_ends
    ceiling_mA = math.floor(1e3 * plan.damper.max_current + 1e-9)
    lines = []
    if plan.drive.kind == BASE and other == "ground":
        lines += ["# The base moves, so accelerometers alone do not tell this damper's stroke."]
    if plan.structure.lever != 1.0:
        lines += [
            "# On a lever: its stroke is not that of its ends; measure it where a law needs it."
        ]
    return [
        *lines,
        "[[damper]]",
        f'name = "{ONLY}"',
        f'end_a = "{first}"',
        f'end_b = "{other}"',
        f"ceiling_mA = {ceiling_mA}    # driver.max_current_A: no command is above it",
        "safe_mA = 0",
        f"coil_lag_us = {round(1e6 * plan.damper.lag_s)}    # the coil's rise_s",
    ]


def scenario_head(plan: Plan, name: str, what: str, duration_s: float) -> list[str]:
    return [
        *head(plan, "quiesce-scenario", f"{plan.name}_{name}", what),
        f'plant = "{PLANT}"',
        f'board = "{BOARD}"',
        f"duration_s = {number(duration_s)}",
    ]


def steps_text(plan: Plan) -> str:
    """Steady vibration at one frequency after the other, each measured at its end."""
    settle_s, measure_s = plan.settle_s, plan.measure_s
    each_s = settle_s + measure_s
    own = "" if plan.drive.is_single else "; natural frequencies are among them"
    what = f"Steady vibration, one frequency of --drive's range after the other{own}."
    lines = scenario_head(plan, "steps", what, each_s * len(plan.freqs_Hz))
    for freq_Hz in plan.freqs_Hz:
        lines += ["", "[[segment]]", 'kind = "sine"', f"freq_Hz = {number(freq_Hz)}",
                  f"duration_s = {number(each_s)}"]  # fmt: skip
    lines += ["", f"# Each after {settle_s:g} s: {DECAYS:g} decay times of the slowest mode, "
              f"{LEAST_SETTLE_s:g} to {MOST_SETTLE_s:g} s."]  # fmt: skip
    for i in range(len(plan.freqs_Hz)):
        start_s = i * each_s + settle_s
        lines += [
            "[[window]]",
            f"start_s = {number(start_s)}",
            f"end_s = {number(start_s + measure_s)}",
        ]
    return "\n".join(lines) + "\n"


def random_text(plan: Plan) -> str:
    """Of the same RMS as the sine, over the whole range."""
    drive = plan.drive
    lines = scenario_head(
        plan,
        "random",
        f"Random {drive.kind} of the RMS of --drive's sine, over its range.",
        RANDOM_s,
    )
    lines += ["", "[[segment]]", 'kind = "random"', f"low_Hz = {number(drive.low_Hz)}",
              f"high_Hz = {number(drive.high_Hz)}",
              f"drive_rms_V = {number(math.sqrt(0.5))}    # 1 V is the amplitude of --drive",
              "seed = 1", f"duration_s = {number(RANDOM_s)}"]  # fmt: skip
    lines += ["", "[[window]]", "start_s = 2.0", f"end_s = {number(RANDOM_s)}"]
    return "\n".join(lines) + "\n"
