"""The damper: what the recording says of it, or a file that 'quiesce identify' wrote."""

import json
import math
import shutil
import tomllib
from pathlib import Path
from typing import Any

import tomli_w

from quiesce.base.errors import UsageError
from quiesce.base.paths import shown
from quiesce.commission.work import DESIGNED, FOUND, Work
from quiesce.plant.library import SAFE_PART, Plant, USUAL_STEP_us
from quiesce.plant.variant import read_plant_data

NAME = "damper"
TITLE = "identify or choose the damper"
FILE = "damper.toml"


def run(work: Work) -> dict[str, Any]:
    """The plant that is tuned for: no current in it is above the limit."""
    found = work.path / FOUND / "plant.toml"
    designed = work.path / DESIGNED
    most_A = work.wants.max_current_A or math.inf
    if work.wants.damper is None:
        write(designed, limited(read_plant_data(found), most_A))
        return {"is_chosen": False, "name": model_of(designed), "parameters": statuses(work)}
    coil = coil_of(work)
    name = put_on(found, Path(work.wants.damper), designed, coil, most_A)
    return {"is_chosen": True, "name": name, "parameters": {}}


def limited(plant: dict[str, Any], most_A: float) -> dict[str, Any]:
    driver = plant["driver"]
    return {**plant, "driver": {**driver, "max_current_A": min(driver["max_current_A"], most_A)}}


def write(file: Path, plant: dict[str, Any]) -> None:
    """UsageError where it is no plant."""
    file.write_text(tomli_w.dumps(plant), encoding="utf-8")
    Plant(file)


def model_of(plant: Path) -> str:
    return str(read_plant_data(plant)["damper"]["model"])


def statuses(work: Work) -> dict[str, str]:
    """Of what was fitted: measured, weak, assumed."""
    rows = json.loads((work.path / FOUND / "identify.json").read_text(encoding="utf-8"))
    return {str(row["name"]): str(row["status"]) for row in rows["parameters"]}


def coil_of(work: Work) -> dict[str, Any] | None:
    """As it was measured in step wiring, else as the base plant says, where it does."""
    lag_s = work.result("wiring").get("lag_s")
    return {"rise_s": lag_s} if lag_s is not None else read_plant_data(work.base_plant).get("coil")


def put_on(
    structure: Path, damper: Path, designed: Path, coil: dict[str, Any] | None, most_A: float
) -> str:
    """Writes a plant file with that damper on the structure; its name. coil: where the damper's
    file has none; None: the structure's. UsageError where they do not go together."""
    shutil.copyfile(damper, designed.with_name(FILE))
    data, own = read_plant_data(structure), read_damper(damper)
    said = {} if "coil" in own else {"coil": coil or data["coil"]}
    rest = {key: one for key, one in data.items() if key not in ("coil", "damper", "integration")}
    plant = limited({**rest, **said, "damper": {"file": FILE}}, min(most_A, most_of_damper_A(own)))
    write(designed, {**plant, "integration": {"max_step_us": 1.0}})
    safe_us = 1e6 * Plant(designed).safe_step_s
    step_us = max(1.0, min(USUAL_STEP_us, SAFE_PART * safe_us))
    write(designed, {**plant, "integration": {"max_step_us": step_us}})
    return str(own.get("name", damper.stem))


def most_of_damper_A(damper: dict[str, Any]) -> float:
    """The largest current that its file holds for."""
    valid = damper.get("valid")
    known = valid.get("current_A") if isinstance(valid, dict) else None
    ends = known if isinstance(known, list) else [known]
    numbers = [float(one) for one in ends if isinstance(one, int | float)]
    return max(numbers, default=math.inf)


def read_damper(file: Path) -> dict[str, Any]:
    try:
        return tomllib.loads(file.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise UsageError(f"{shown(file)}: not a damper file: {error}")


def line(result: dict[str, Any]) -> str:
    if result["is_chosen"]:
        return f"{result['name']}, as its file says"
    doubtful = [name for name, status in result["parameters"].items() if status == "weak"]
    return f"{result['name']}, from the recording" + (
        f"; not well known: {', '.join(doubtful)}" if doubtful else ""
    )
