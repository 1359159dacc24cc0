"""Tables of the page about boards, of the committed results."""

from collections.abc import Callable
from typing import Any

from quiesce_benchmarks.board.parts import bits, resources
from quiesce_benchmarks.house.committed import Committed
from quiesce_benchmarks.house.markdown import count, markdown

UNKNOWN = "Not recorded yet: `./tools/benchmark board` prints it.\n"
SHOWN_DIGITS = 16


def board_table(part: str, committed: Committed) -> str:
    """Of one part of the benchmark. KeyError where there is no such one."""
    make: Callable[[dict[str, Any]], str] = {
        "bits": _bits,
        "budget": _budget,
        "path": _path,
        "resources": _resources,
    }[part]
    if "board" not in committed.files:
        return UNKNOWN
    reported = committed.files["board"]["context"]["reported"].get(part, {})
    return make(reported) if reported else UNKNOWN


def _bits(reported: dict[str, Any]) -> str:
    rows = [
        [bits.TARGETS[preset], f"`{preset}`", f"`{sha[:SHOWN_DIGITS]}`"]
        for preset, sha in reported["sha256"].items()
    ]
    return markdown(["target", "preset", "SHA-256 begins"], rows)


def _budget(reported: dict[str, Any]) -> str:
    head = ["law", "worst tick", "worst tick of the node", "its median", "stack of a tick, bytes"]
    rows = [[f"`{law}`", *map(count, row.values())] for law, row in reported["laws"].items()]
    return markdown(head, rows)


def _path(reported: dict[str, Any]) -> str:
    rows = [
        [f"`{helper}`", ", ".join(f"`{one}`" for one in callers)]
        for helper, callers in reported["division"].items()
    ]
    return markdown(["helper", "called by"], rows)


def _resources(reported: dict[str, Any]) -> str:
    rows = [
        [group, *(count(row.get(port, 0)) for port in resources.PORTS)]
        for group, row in reported["sizes"].items()
    ]
    return markdown(["bytes", *(f"`{port}`" for port in resources.PORTS)], rows)
