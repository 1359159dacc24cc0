"""Tables of pages about installing and embedding, of the committed results."""

from quiesce_benchmarks.house.committed import Committed
from quiesce_benchmarks.house.markdown import count, markdown

UNKNOWN = "Not recorded yet: `./tools/benchmark install` prints it.\n"


def install_table(part: str, committed: Committed) -> str:
    """Of one part of the benchmark. KeyError where there is no such one."""
    make = {"footprint": _footprint}[part]
    if "install" not in committed.files:
        return UNKNOWN
    return make(committed.files["install"]["context"]["reported"].get(part, {}))


def _footprint(reported: dict[str, dict[str, dict[str, int]]]) -> str:
    if not reported.get("sizes"):
        return UNKNOWN
    rows = [
        [name, count(size["flash_B"]), count(size["ram_B"])]
        for name, size in reported["sizes"].items()
    ]
    return markdown(["the library holds", "flash, bytes", "memory, bytes"], rows)
