"""Tables of pages about laws, of the committed results."""

from typing import Any

from quiesce_benchmarks.house.committed import Committed
from quiesce_benchmarks.house.markdown import markdown
from quiesce_benchmarks.laws.parts import cantilever, cost

UNKNOWN = "Not recorded yet: `./tools/benchmark laws` prints it.\n"


def law_table(name: str, committed: Committed) -> str:
    """`costs` or `cantilever`. KeyError where there is no such one."""
    make = {"costs": _costs, "cantilever": _cantilever}[name]
    return make(committed.files["laws"]) if "laws" in committed.files else UNKNOWN


def _reported(result: dict[str, Any], part: str) -> dict[str, Any]:
    found: dict[str, Any] = result["context"]["reported"].get(part, {})
    return found


def _costs(result: dict[str, Any]) -> str:
    reported = _reported(result, "cost")
    if not reported:
        return UNKNOWN
    rows = [cost.cells(label.partition(",")[0], row) for label, row in reported["costs"].items()]
    return markdown(cost.HEAD, rows)


def _cantilever(result: dict[str, Any]) -> str:
    reported = _reported(result, "cantilever")
    return markdown(cantilever.HEAD, cantilever.table_rows(reported)) if reported else UNKNOWN
