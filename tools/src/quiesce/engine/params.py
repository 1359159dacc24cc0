"""Parameters as `--set NAME=VALUE` gives them, checked against what the firmware says of itself."""

import tomllib
from collections.abc import Sequence
from functools import cache
from typing import Any

from quiesce.base.errors import UsageError
from quiesce.base.paths import root
from quiesce.engine.bench import Bench

FILE = "firmware/param/parameters.toml"


@cache
def parameters() -> tuple[dict[str, Any], ...]:
    """In the order of their indices, as the bench tells them, without it."""
    with (root() / FILE).open("rb") as file:
        rows = tomllib.load(file)["parameter"]
    return tuple(parameter_of(index, row) for index, row in enumerate(rows))


def parameter_of(index: int, row: dict[str, Any]) -> dict[str, Any]:
    """One with labels takes their numbers."""
    numbers = {"min": 0, "max": len(row["labels"]) - 1} if "labels" in row else {}
    return {"choices": None, "labels": None, **numbers, **row, "index": index}


def allowed(param: dict[str, Any]) -> str:
    """The values that a parameter may have, in words."""
    if param["labels"]:
        return ", ".join(param["labels"])
    if param["choices"]:
        return ", ".join(str(choice) for choice in param["choices"])
    return f"{param['min']} .. {param['max']}"


def expected(param: dict[str, Any]) -> str:
    if param["labels"] or param["choices"]:
        return f"one of {allowed(param)}"
    return f"an integer in {allowed(param)} {param['unit']}".removesuffix(" -")


def default(param: dict[str, Any]) -> str:
    return param["labels"][param["default"]] if param["labels"] else str(param["default"])


def parse_value(param: dict[str, Any], text: str) -> int:
    """An integer or a label. UsageError where the parameter does not allow it."""
    labels = param["labels"] or []
    try:
        value = labels.index(text) if text in labels else int(text)
    except ValueError:
        value = None
    if (
        value is None
        or not param["min"] <= value <= param["max"]
        or (param["choices"] and value not in param["choices"])
    ):
        raise UsageError(f"--set {param['name']}={text}: {param['name']} is {expected(param)}")
    return value


def effective_params(bench: Bench, settings: Sequence[str]) -> dict[str, int]:
    """Every parameter's value after the settings, in order."""
    known = {param["name"]: param for param in bench.json("params")}
    values = {name: param["default"] for name, param in known.items()}
    for setting in settings:
        name, equals, text = setting.partition("=")
        if not equals:
            raise UsageError(f"--set {setting}: expected NAME=VALUE")
        if name not in known:
            raise UsageError(f"--set {setting}: no parameter '{name}'; 'quiesce params' lists all")
        values[name] = parse_value(known[name], text)
    return values
