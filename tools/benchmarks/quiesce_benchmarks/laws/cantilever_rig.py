"""The frozen cantilever for laws with forces: its twin of a thousand times the mass.

The damper's largest force is 3.4 mN, and the controller counts whole mN. With every mass, the
damper's force and the shaker's a thousand times as large the motion is the same to rounding, and
the forces are in N. Its board has the published rig's accelerometer; where a law or tracker needs
the force, a load cell of 10 N beside it, which the published rig does not have at this resolution.
"""

import math
import tempfile
import tomllib
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import tomli_w
from quiesce.base.errors import UsageError
from quiesce.base.paths import root
from quiesce.damper.force_map import map_words
from quiesce.damper.inverse import monotone_range
from quiesce.damper.simulate import simulator_of_file
from quiesce.engine.bench import Bench
from quiesce.law.recipe import Made, Recipe, make
from quiesce.law.rig import LawRig, load_rig
from quiesce.table.file import table_bytes

from quiesce_benchmarks.control.measures import reduction_pct
from quiesce_benchmarks.control.scenarios import NOISE_mg, Scenario, sine

PLANT = root() / "sim_hil/data/plants/squeeze_2012.toml"
BOARD = root() / "sim_hil/data/boards/squeeze_2012.toml"
FILM = root() / "sim_hil/data/dampers/squeeze_2012_film.toml"
HEAVIER = 1000.0
RATE_Hz = 1000
CELL = {
    "name": "force", "measures": "force", "of": "damper", "scale_mN": 0.305,
    "full_scale_counts": 32767, "stuck_us": 0,
}  # fmt: skip
CELL_NOISE_mN = 2.0
um_s2_PER_mg = 9806.65
# Of the map of tracker inverse: around the motion at the published drive.
MAP_AMPLITUDE_m, MAP_SPEED_m_s = 2e-4, 0.02
STEADY_s, LAST_s = 8.0, 2.0
FREQS_Hz = (5.0, 10.0, 15.0, 20.0)
STEP = Scenario(
    "step",
    10.0,
    (sine(10.0, duration_s=4.0), sine(20.0)),
    ((2.0, 4.0), (8.0, 10.0)),
    transient_s=(4.0, 6.0),
)


def steady(freq_Hz: float) -> Scenario:
    return Scenario(f"{freq_Hz:g}_Hz", STEADY_s, (sine(freq_Hz),), ((STEADY_s - LAST_s, STEADY_s),))


@dataclass(frozen=True)
class Cantilever:
    """Files of the twin. plants, boards: without and with the load cell. structure: its matrices
    in modal coordinates, for recipes."""

    plants: tuple[Path, Path]
    boards: tuple[Path, Path]
    structure: Path
    force_map: Path


def twin(data: dict[str, Any], body: str) -> dict[str, Any]:
    """A plant file of modes, heavier, with its two nodes named: where it is driven, and the body
    that sensor and damper are at."""
    root_of = math.sqrt(HEAVIER)
    modes = [
        {
            "freq_Hz": mode["freq_Hz"],
            "damping_ratio": mode["damping_ratio"],
            "shape": [mode["at_force"] / root_of, mode["at_damper"] / root_of],
            "base_participation": mode["base_participation"] * root_of,
        }
        for mode in data["structure"]["mode"]
    ]
    damper = {**data["damper"], "force_scale": data["damper"]["force_scale"] * HEAVIER}
    shaker = {**data["shaker"], "gain_N_V": data["shaker"]["gain_N_V"] * HEAVIER}
    structure = {
        "kind": "nodes", "nodes": ["driven", body], "force": "driven", "sensor": body,
        "damper": body, "mode": modes,
    }  # fmt: skip
    return {**data, "structure": structure, "damper": damper, "shaker": shaker}


def matrices(data: dict[str, Any], body: str, damper: str) -> dict[str, Any]:
    """The same structure as matrices: modal coordinates have a mass of 1 kg."""
    modes = data["structure"]["mode"]
    pulsations = [2.0 * math.pi * mode["freq_Hz"] for mode in modes]

    def diagonal(values: list[float]) -> list[list[float]]:
        return [[x if i == k else 0.0 for k in range(len(values))] for i, x in enumerate(values)]

    return {
        "structure": {
            "kind": "matrices",
            "mass_kg": diagonal([1.0 for _ in modes]),
            "damping_N_s_m": diagonal(
                [2.0 * m["damping_ratio"] * w for m, w in zip(modes, pulsations, strict=True)]
            ),
            "stiffness_N_m": diagonal([w * w for w in pulsations]),
            "base": [mode["base_participation"] for mode in modes],
        },
        "place": [{"name": body, "at": [mode["shape"][-1] for mode in modes]}],
        "damper": [{"name": damper, "a": body, "b": "ground"}],
    }


def make_rig(folder: Path) -> Cantilever:
    board = tomllib.loads(BOARD.read_text(encoding="utf-8"))
    body, damper = board["bodies"][0], board["damper"][0]["name"]
    data = twin(tomllib.loads(PLANT.read_text(encoding="utf-8")), body)
    with_cell = {**board, "sensor": [*board["sensor"], {**CELL, "of": damper}]}
    noise = {board["sensor"][0]["name"]: NOISE_mg * um_s2_PER_mg}
    without_cell = {**data, "noise": noise}
    with_noisy_cell = {**data, "noise": {**noise, CELL["name"]: CELL_NOISE_mN}}
    made = Cantilever(
        (folder / "plant.toml", folder / "plant_with_cell.toml"),
        (folder / "board.toml", folder / "board_with_cell.toml"),
        folder / "structure.toml",
        folder / "map.table",
    )
    for file, content in (
        (made.plants[0], without_cell),
        (made.plants[1], with_noisy_cell),
        (made.boards[0], board),
        (made.boards[1], with_cell),
        (made.structure, matrices(data, body, damper)),
    ):
        file.write_text(tomli_w.dumps(content), encoding="utf-8")
    made.force_map.write_bytes(table_bytes(map_of_film(folder)))
    return made


def map_of_film(folder: Path) -> list[int]:
    """Around mid-stroke; the film's force grows with the current at every velocity."""
    data = tomllib.loads(FILM.read_text(encoding="utf-8"))
    data["parameters"]["force_scale"] *= HEAVIER
    file = folder / "film.toml"
    file.write_text(tomli_w.dumps(data), encoding="utf-8")
    model, _ = simulator_of_file(file)
    moved = replace(model, stroke_m=2.0 * MAP_AMPLITUDE_m, speed_m_s=MAP_SPEED_m_s)
    return map_words(monotone_range(moved, most_A()))


def most_A() -> float:
    return float(tomllib.loads(PLANT.read_text(encoding="utf-8"))["driver"]["max_current_A"])


def made_for(
    rigs: tuple[LawRig, LawRig], recipe: Recipe, values: dict[str, float]
) -> tuple[Made, bool]:
    """With what the rig measures, or where that does not do, with the load cell (True)."""
    needs_cell = recipe.tracker in ("compare", "proportional")
    if not needs_cell:
        try:
            return make(recipe, rigs[0], values), False
        except UsageError:
            pass
    return make(recipe, rigs[1], values), True


def law_rigs(made: Cantilever) -> tuple[LawRig, LawRig]:
    plain, with_cell = (load_rig(Bench(), one, made.structure, RATE_Hz) for one in made.boards)
    return plain, with_cell


@dataclass(frozen=True)
class Control:
    """A law for the bench. on: None, the frozen plant as it is; 0, 1: its twin without and with
    the load cell."""

    law: str
    options: tuple[str, ...] = ()
    on: int | None = None


@dataclass(frozen=True)
class Outcome:
    """Against 0 A: reductions in %, by window; mean current in A."""

    amp_pct: tuple[float, ...]
    accel_pct: tuple[float, ...]
    mean_current_A: float
    transient_rms_um: float | None = None


def scenario_file(made: Cantilever, scenario: Scenario, on: int | None) -> Path:
    """Written anew each time, whole: several workers ask."""
    document = scenario.document(PLANT if on is None else made.plants[on])
    if on is not None:
        del document["noise_mg"]  # the plant says it of each sensor
        document["board"] = str(made.boards[on])
    with tempfile.NamedTemporaryFile("w", dir=made.structure.parent, delete=False) as file:
        file.write(tomli_w.dumps(document))
    return Path(file.name)


def run(bench: Bench, file: Path, control: Control, seed: int) -> dict[str, Any]:
    """The bench's figures of a scenario's file."""
    words = ["--scenario", str(file), "--law", control.law, "--seed", str(seed)]
    found: dict[str, Any] = bench.json("run", *words, *control.options)
    return found


def outcome(figures: dict[str, Any], off: dict[str, Any]) -> Outcome:
    """off: the same without current."""
    pairs = list(zip(figures["windows"], off["windows"], strict=True))

    def pct(key: str) -> tuple[float, ...]:
        return tuple(reduction_pct(one[key], base[key]) for one, base in pairs)

    is_step = len(pairs) > 1
    return Outcome(
        pct("amp_um"),
        pct("accel_rms_mm_s2"),
        figures["mean_current_A"],
        figures["rms_disp_um"] if is_step else None,
    )
