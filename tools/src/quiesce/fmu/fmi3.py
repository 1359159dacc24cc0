"""FMI 3.0: the description, and where the library is in the archive."""

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

BINARIES = "binaries/x86_64-linux"
TYPES = {"real": "Float64", "integer": "Int32", "boolean": "Boolean"}


def description(model: Model) -> bytes:
    root = root_of(model, "3.0", "instantiationToken")
    SubElement(
        root,
        "CoSimulation",
        {
            "modelIdentifier": model.identifier,
            "canGetAndSetFMUState": "true",
            "canSerializeFMUState": "true",
            "canHandleVariableCommunicationStepSize": "true",
        },
    )
    add_units(root, model)
    add_experiment(root, model)
    variables = SubElement(root, "ModelVariables")
    for reference, variable in enumerate(model.description.variables):
        add_variable(variables, reference, variable)
    SubElement(
        variables,
        "Float64",
        {
            "name": "time",
            "valueReference": str(len(model.description.variables)),
            "causality": "independent",
            "variability": "continuous",
        },
    )
    structure = SubElement(root, "ModelStructure")
    for name in ("Output", "InitialUnknown"):
        for reference in outputs(model):
            SubElement(structure, name, {"valueReference": str(reference)})
    return written(root)


def add_variable(variables: Element, reference: int, variable: Variable) -> None:
    attributes = {
        "name": variable.name,
        "valueReference": str(reference),
        "description": variable.description,
        "causality": variable.causality,
        "variability": variable.variability,
        **limits_of(variable),
    }
    if variable.unit:
        attributes["unit"] = variable.unit
    if variable.causality != "output":
        attributes["start"] = start_of(variable)
    SubElement(variables, TYPES[variable.type], attributes)
