"""FMI 2.0: the description, and where the library is in the archive."""

from xml.etree.ElementTree import Element, SubElement

from quiesce.fmu.library import Variable
from quiesce.fmu.xml import (
    Model,
    add_experiment,
    add_units,
    limits_of,
    outputs,
    root_of,
    start_of,
    written,
)

BINARIES = "binaries/linux64"
TYPES = {"real": "Real", "integer": "Integer", "boolean": "Boolean"}


def description(model: Model) -> bytes:
    root = root_of(model, "2.0", "guid")
    SubElement(
        root,
        "CoSimulation",
        {
            "modelIdentifier": model.identifier,
            "canHandleVariableCommunicationStepSize": "true",
            "canNotUseMemoryManagementFunctions": "true",
            "canGetAndSetFMUstate": "true",
            "canSerializeFMUstate": "true",
        },
    )
    add_units(root, model)
    add_experiment(root, model)
    variables = SubElement(root, "ModelVariables")
    for reference, variable in enumerate(model.description.variables):
        add_variable(variables, reference, variable)
    structure = SubElement(root, "ModelStructure")
    for name in ("Outputs", "InitialUnknowns"):
        unknowns = SubElement(structure, name)
        for reference in outputs(model):
            SubElement(unknowns, "Unknown", {"index": str(reference + 1)})
    return written(root)


def add_variable(variables: Element, reference: int, variable: Variable) -> None:
    is_output = variable.causality == "output"
    attributes = {
        "name": variable.name,
        "valueReference": str(reference),
        "description": variable.description,
        "causality": variable.causality,
        "variability": variable.variability,
    }
    if variable.causality != "input":
        attributes["initial"] = "calculated" if is_output else "exact"
    scalar = SubElement(variables, "ScalarVariable", attributes)
    typed = limits_of(variable)
    if variable.unit:
        typed["unit"] = variable.unit
    if not is_output:
        typed["start"] = start_of(variable)
    SubElement(scalar, TYPES[variable.type], typed)
