"""Graphs of equations (graph.py) as C11."""

from collections.abc import Mapping, Sequence
from typing import Any

from quiesce.damper.export.c_names import literal
from quiesce.damper.export.graph import (
    Function,
    Language,
    Node,
    called_in,
    folded,
    functions,
    written,
)

_TYPES = {"number": "double", "bits": "uint64_t", "truth": "int"}
_INT_OPERATORS = {"bits+": "+", "bits-": "-", "&": "&", "|": "|", "^": "^"}

BITS = """static uint64_t bits_of(double value) {
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    return bits;
}

static double from_bits(uint64_t bits) {
    double value;
    memcpy(&value, &bits, sizeof value);
    return value;
}
"""


def leaf(node: Node) -> str:
    if node.what == "number":
        return literal(float(node.value))
    if node.what == "integer":
        return f"UINT64_C(0x{int(node.value) % 2**64:016x})"
    return str(node.value)


def call(what: str, of: list[str], value: Any) -> str:
    if what == "select":
        return f"({of[0]} ? {of[1]} : {of[2]})"
    if what == "bits":
        return f"bits_of({of[0]})"
    if what == "<<":
        return f"({of[0]} << {value})"
    if what == ">>":
        return f"(uint64_t)((int64_t)({of[0]}) >> {value})"
    if what in _INT_OPERATORS:
        return f"({of[0]} {_INT_OPERATORS[what]} {of[1]})"
    return f"{'sqrt' if what == 'square_root' else what}({', '.join(of)})"


C = Language(leaf, call, 6)


def statements(
    nodes: Sequence[Node], roots: Sequence[int], targets: Sequence[str], indent: str = "    "
) -> str:
    """Lines that compute the roots; a target is what stands before one: "return", "rates[0] ="."""
    result = written(nodes, roots, C)
    lines = [f"const {_TYPES[kind]} {name} = {text};" for name, kind, text in result.steps]
    lines += [f"{target} {text};" for target, text in zip(targets, result.roots, strict=True)]
    return "\n".join(indent + folded(line, indent) for line in lines)


def function_text(one: Function) -> str:
    arguments = ", ".join(f"double {name}" for name in one.arguments)
    body = statements(one.nodes, [one.result], ["return"])
    return f"static double {one.name}({arguments}) {{\n{body}\n}}\n"


def functions_text(names: set[str]) -> str:
    """Those of these names and what they need, in an order in which C knows each in time."""
    needed = set(names)
    for name in names:
        needed |= called_in(functions()[name].nodes, [functions()[name].result])
    texts = [function_text(one) for one in functions().values() if one.name in needed]
    uses_bits = any("bits_of(" in text or "from_bits(" in text for text in texts)
    return "\n".join([BITS] * uses_bits + texts)


def taken(names: Sequence[str], sources: Mapping[str, str], pointers: Sequence[str]) -> str:
    """Lines that give names their values, and a word for every argument that is not used."""
    lines = [f"    const double {name} = {sources[name]};" for name in names if name in sources]
    used = " ".join(lines)
    lines += [
        f"    (void){one};" for one in pointers if f"{one}[" not in used and f"{one}->" not in used
    ]
    return "\n".join(lines)
