"""The equations of damper models as graphs, and graphs as statements of another language.

The compiled library runs its own text (sim_hil/damper) on numbers that remember how they were
computed, so that an export has the same equations in the same order of operations: nothing is
written twice (sim_hil/python/equations/traced.h).
"""

import textwrap
from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

from quiesce.damper.library import module

LEAVES = ("number", "integer", "name")
# Binds tighter the higher; an operand on the right of - and / has to bind tighter still.
_PRECEDENCE = {"<": 3, ">": 3, "<=": 3, ">=": 3, "+": 4, "-": 4, "*": 5, "/": 5}
TIGHTEST = 9


@dataclass(frozen=True)
class Node:
    """`what` is "number", "integer", "name", an operation (traced.h) or a function's name; `of` are
    the places of what it is made of; `value` is a number, an integer or a name."""

    what: str
    of: tuple[int, ...]
    value: float | int | str


@dataclass(frozen=True)
class Equations:
    """One model: places in `nodes` of the force (N), of the states' rates, and of the bound of how
    fast the states change (1/s)."""

    nodes: tuple[Node, ...]
    force_N: int
    rates: tuple[int, ...]
    fastest_rate_1_s: int


@dataclass(frozen=True)
class Function:
    name: str
    arguments: tuple[str, ...]
    nodes: tuple[Node, ...]
    result: int


@cache
def equations() -> Mapping[str, Equations]:
    """Of every model of equations, by name."""
    return {
        name: Equations(_nodes(one), one["force_N"], tuple(one["rates"]), one["fastest_rate_1_s"])
        for name, one in module().equations().items()
    }


@cache
def functions() -> Mapping[str, Function]:
    """What nodes call, each after those that it calls; "effective" is the field law."""
    return {
        one["name"]: Function(one["name"], tuple(one["arguments"]), _nodes(one), one["result"])
        for one in module().functions()
    }


def _nodes(table: Mapping[str, Any]) -> tuple[Node, ...]:
    return tuple(Node(what, tuple(of), value) for what, of, value in table["nodes"])


def reached(nodes: Sequence[Node], roots: Iterable[int]) -> list[int]:
    """Places of all that the roots are made of, in order."""
    found: set[int] = set()
    waiting = list(roots)
    while waiting:
        place = waiting.pop()
        if place not in found:
            found.add(place)
            waiting.extend(nodes[place].of)
    return sorted(found)


def names_in(nodes: Sequence[Node], roots: Iterable[int]) -> list[str]:
    places = reached(nodes, roots)
    return sorted({str(nodes[k].value) for k in places if nodes[k].what == "name"})


def called_in(nodes: Sequence[Node], roots: Iterable[int]) -> set[str]:
    """Functions that are called, with those that these call."""
    direct = {nodes[k].what for k in reached(nodes, roots)} & set(functions())
    found = set(direct)
    for name in direct:
        one = functions()[name]
        found |= called_in(one.nodes, [one.result])
    return found


@dataclass(frozen=True)
class Language:
    """How a node is written: leaf(node), and call(what, texts of the operands, node's value) for
    what is no operator. minus: how tightly a leading minus binds; operators are at 3 .. 5."""

    leaf: Callable[[Node], str]
    call: Callable[[str, list[str], Any], str]
    minus: int


@dataclass(frozen=True)
class Written:
    """Intermediate results in order, as (name, kind, expression), and the roots' expressions. kind:
    "number", "bits" or "truth"."""

    steps: list[tuple[str, str, str]]
    roots: list[str]


def written(
    nodes: Sequence[Node], roots: Sequence[int], language: Language, prefix: str = "t"
) -> Written:
    """What is used more than once gets a name, t0, t1, ..; the rest stands where it is used."""
    places = reached(nodes, roots)
    uses = Counter(place for k in places for place in nodes[k].of)
    uses.update(roots)
    texts: dict[int, tuple[str, int]] = {}
    steps: list[tuple[str, str, str]] = []
    for k in places:
        text, precedence = _text(nodes[k], [texts[j] for j in nodes[k].of], language)
        if uses[k] > 1 and nodes[k].what not in LEAVES:
            name = f"{prefix}{len(steps)}"
            steps.append((name, kind_of(nodes[k].what), text))
            text, precedence = name, TIGHTEST
        texts[k] = (text, precedence)
    return Written(steps, [texts[root][0] for root in roots])


def _text(node: Node, of: list[tuple[str, int]], language: Language) -> tuple[str, int]:
    if node.what in LEAVES:
        text = language.leaf(node)
        return text, language.minus if text.startswith("-") else TIGHTEST
    if node.what == "negative":
        return f"-{_held(of[0], TIGHTEST)}", language.minus
    own = _PRECEDENCE.get(node.what)
    if own is None:
        return language.call(node.what, [text for text, _ in of], node.value), TIGHTEST
    # Sums and products are taken from the left, as in the source.
    return f"{_held(of[0], own)} {node.what} {_held(of[1], own + 1)}", own


def _held(part: tuple[str, int], least: int) -> str:
    text, precedence = part
    return text if precedence >= least else f"({text})"


def kind_of(what: str) -> str:
    if what in ("bits", "bits+", "bits-", "&", "|", "^", "<<", ">>", "integer"):
        return "bits"
    return "truth" if what in ("<", ">", "<=", ">=") else "number"


def folded(text: str, indent: str) -> str:
    """Broken at blanks below 100 columns."""
    lines = textwrap.wrap(text, 98 - len(indent), break_long_words=False, break_on_hyphens=False)
    return f"\n{indent}    ".join(lines)
