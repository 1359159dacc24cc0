"""Structures, records and tables that the parts share."""

import tomllib
from functools import cache
from pathlib import Path

import tomli_w
from quiesce.base.errors import UsageError
from quiesce.base.paths import measurements, root, shown
from quiesce.compare.laws import ComparedLaw
from quiesce.compare.records import Record, read_record
from quiesce.compare.run import Comparison, Shaking
from quiesce.damper.bank.fit import fit_bank
from quiesce.damper.bank.table import bank_words
from quiesce.damper.force_map import map_words
from quiesce.damper.inverse import forces_by, monotone_range
from quiesce.damper.learned.model import silent
from quiesce.damper.simulate import simulator_of_file
from quiesce.engine.bench import Bench
from quiesce.law.recipe import Made, make, values_of
from quiesce.law.recipes import find
from quiesce.law.rig import LawRig, load_rig
from quiesce.table.file import table_bytes

BUILDING, CAR, TWO_MASSES = "three_storeys_1996", "quarter_car", "mrd_mre_2014"
EL_CENTRO = "el_centro_1940_ns"
FIVE_TIMES = 5.0


def files(rig: str) -> tuple[Path, Path]:
    """Plant and board."""
    data = root() / "sim_hil/data"
    return data / f"plants/{rig}.toml", data / f"boards/{rig}.toml"


@cache
def records() -> tuple[Record, ...]:
    """UsageError where the recorded earthquakes are not beside the project."""
    folder = measurements("earthquake")
    found = sorted(folder.glob("*.csv"))
    if not found:
        raise UsageError(f"no recorded earthquakes in {shown(folder)}")
    return tuple(read_record(file) for file in found)


def el_centro() -> Record:
    return next(record for record in records() if record.name == EL_CENTRO)


@cache
def law_rig(rig: str) -> LawRig:
    plant, board = files(rig)
    return load_rig(Bench(), board, plant, 1000)


def made(rig: str, recipe: str, settings: dict[str, float] | None = None) -> Made:
    words = [f"{name}={value!r}" for name, value in (settings or {}).items()]
    return make(find(recipe), law_rig(rig), values_of(find(recipe), words))


def map_of(folder: Path, damper: str, most_A: float) -> Path:
    """Map of a damper that ships, for tracker inverse."""
    model, simulate = simulator_of_file(root() / f"sim_hil/data/dampers/{damper}.toml")
    found = monotone_range(model, most_A, simulate=None if model.is_kernel else simulate)
    file = folder / "map.table"
    file.write_bytes(table_bytes(map_words(found)))
    return file


@cache
def bank_of(damper: str, most_A: float, seed: int = 1) -> list[int]:
    """Words of a bank of a damper that ships, for tracker bank."""
    model, simulate = simulator_of_file(root() / f"sim_hil/data/dampers/{damper}.toml")
    forces = forces_by(model, None if model.is_kernel else simulate)
    return bank_words([fit_bank(model, forces, most_A, 1000, seed, silent).bank])


def compared(
    folder: Path, label: str, table: Made, *settings: str, map_file: Path | None = None
) -> ComparedLaw:
    """A law of a recipe, its table in a file of this folder."""
    file = folder / f"{label.replace(' ', '_')}.table"
    file.write_bytes(table_bytes(table.table.words()))
    of_map = () if map_file is None else ("--force-map", str(map_file))
    options = [word for one in settings for word in ("--set", one)]
    return ComparedLaw(label, table.table.law, ("--law-table", str(file), *of_map, *options))


def comparison(rig: str, shaking: Shaking) -> Comparison:
    return Comparison(Bench(), *files(rig), shaking)


def bare(folder: Path, rig: str) -> Path:
    """The plant with dampers that do nothing."""
    plant, _ = files(rig)
    data = tomllib.loads(plant.read_text(encoding="utf-8"))
    data["damper"] = [
        {
            "name": one["name"], "a": one["a"], "b": one["b"], "model": "viscous",
            "base_N_s_m": 0.0, "per_A_N_s_m": 0.0, "stroke_m": 1.0,
            "coil": {"rise_s": 0.0, "fall_s": 0.0},
        }
        for one in data["damper"]
    ]  # fmt: skip
    file = folder / f"{rig}_bare.toml"
    file.write_text(tomli_w.dumps(data), encoding="utf-8")
    return file
