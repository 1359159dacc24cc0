"""modelDescription.xml: what both versions of the standard say alike."""

import xml.etree.ElementTree as ElementTree
from dataclasses import dataclass
from xml.etree.ElementTree import Element, SubElement

from quiesce import __version__
from quiesce.fmu.library import Description, Variable

STOP_s = 10
# Exponents of SI units, and the offset of the one unit that has one.
UNITS = {
    "A": {"A": 1},
    "Hz": {"s": -1},
    "N": {"kg": 1, "m": 1, "s": -2},
    "V": {"kg": 1, "m": 2, "s": -3, "A": -1},
    "degC": {"K": 1, "offset": 273.15},
    "m": {"m": 1},
    "m/s": {"m": 1, "s": -1},
    "m/s2": {"m": 1, "s": -2},
}


@dataclass(frozen=True)
class Model:
    name: str
    identifier: str  # of its library's file, a name of C
    token: str
    text: str  # what it is, in a line
    description: Description


def root_of(model: Model, version: str, token_name: str) -> Element:
    return Element(
        "fmiModelDescription",
        {
            "fmiVersion": version,
            "modelName": model.name,
            token_name: model.token,
            "description": model.text,
            "generationTool": f"quiesce {__version__}",
            "variableNamingConvention": "flat",
        },
    )


def add_units(root: Element, model: Model) -> None:
    used = sorted({one.unit for one in model.description.variables if one.unit})
    if used:
        units = SubElement(root, "UnitDefinitions")
        for name in used:
            unit = SubElement(units, "Unit", {"name": name})
            exponents = {key: str(value) for key, value in UNITS[name].items()}
            SubElement(unit, "BaseUnit", exponents)


def add_experiment(root: Element, model: Model) -> None:
    SubElement(SubElement(root, "LogCategories"), "Category", {"name": "logStatusError"})
    SubElement(
        root,
        "DefaultExperiment",
        {"startTime": "0", "stopTime": str(STOP_s), "stepSize": repr(model.description.tick_s)},
    )


def start_of(variable: Variable) -> str:
    if variable.type == "boolean":
        return "true" if variable.start else "false"
    return str(int(variable.start)) if variable.type == "integer" else repr(variable.start)


def limits_of(variable: Variable) -> dict[str, str]:
    """Attributes min and max, those that there are."""
    limits = {"min": variable.min, "max": variable.max}
    whole = variable.type == "integer"
    return {
        name: str(int(value)) if whole else repr(value)
        for name, value in limits.items()
        if value is not None
    }


def outputs(model: Model) -> list[int]:
    """Their value references."""
    variables = enumerate(model.description.variables)
    return [index for index, one in variables if one.causality == "output"]


def written(root: Element) -> bytes:
    ElementTree.indent(root)
    return ElementTree.tostring(root, encoding="utf-8", xml_declaration=True) + b"\n"
