"""The page that an FMU carries: what it is, and its variables."""

from quiesce.fmu.library import Variable
from quiesce.fmu.xml import Model, start_of
from quiesce.report.page import render


def page_of(model: Model, kind: str) -> str:
    columns = ("name", "kind", "type", "unit", "start", "limits", "meaning")
    rows = [row_of(variable) for variable in model.description.variables]
    return render(
        "fmu/page.html.j2",
        model=model,
        kind=kind,
        tick_ms=f"{1e3 * model.description.tick_s:g}",
        table=(columns, rows),
    )


def row_of(variable: Variable) -> list[str]:
    is_output = variable.causality == "output"
    has_limits = variable.min is not None and variable.max is not None
    return [
        variable.name,
        f"{variable.variability} {variable.causality}"
        if variable.causality == "parameter"
        else variable.causality,
        variable.type,
        variable.unit or "-",
        "" if is_output else start_of(variable),
        f"{variable.min:g} .. {variable.max:g}" if has_limits else "",
        variable.description,
    ]
