"""What the tick reaches of the compiler's and C's libraries."""

import re

from quiesce.base.paths import build_folder
from quiesce.base.table import format_table
from quiesce.engine.bench import require_file

from quiesce_benchmarks.board.disassembly import call_graph
from quiesce_benchmarks.part import Effort, Measured

TITLE = "path: what the tick calls of libraries"
FIGURES = (
    ("tick_library_float_heap_text", "functions", 0.0, "lower"),
    ("tick_library_division", "functions", 0.0, "lower"),
    ("tick_functions", "functions", None, "lower"),
)
ENTRY = "node_tick"
FORBIDDEN = re.compile(
    r"__aeabi_[fd][0-9a-z_]*|__aeabi_[a-z]+2[fd]|__[a-z]+[sd]f[0-9]?"
    r"|_*(malloc|calloc|realloc|free|sbrk)(_r)?|_*[a-z]*printf(_r)?"
)
# Those that anybody calls; what they call themselves is theirs.
DIVISION = re.compile(r"__aeabi_u?[il]div(mod)?|__aeabi_u?ldivmod|__u?(div|mod)[a-z]*[sd]i[34]")


def measure(effort: Effort) -> Measured:
    file = build_folder() / "budget/targets/mps2/quiesce_mps2_node.elf"
    graph = call_graph(require_file(file, "the image"))
    reached = graph.reachable(ENTRY)
    own = {one for one in reached if not DIVISION.fullmatch(one)}
    foreign = sorted(one for one in reached if FORBIDDEN.fullmatch(one))
    # Where the firmware itself asks for it.
    division = {one: graph.callers(one, own) for one in sorted(reached - own)}
    division = {one: callers for one, callers in division.items() if callers}
    rows = [[one, ", ".join(callers)] for one, callers in division.items()]
    table = format_table(["division helper", "called in the tick by"], rows, left=(0, 1))
    values: dict[str, float | None] = {
        "tick_library_float_heap_text": len(foreign),
        "tick_library_division": len(division),
        "tick_functions": len(reached),
    }
    return Measured(values, {"foreign": foreign, "division": division}, (table,) if rows else ())
