"""Small mistakes in C sources: each one a mutant that some test should notice."""

import re
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cache

import tree_sitter_c
from tree_sitter import Language, Node, Parser

# Operator -> what it is mistaken for.
SWAPS = {
    "<": ("<=", ">="),
    "<=": ("<", ">"),
    ">": (">=", "<="),
    ">=": (">", "<"),
    "==": ("!=",),
    "!=": ("==",),
    "+": ("-",),
    "-": ("+",),
    "*": ("/",),
    "/": ("*",),
    "%": ("/",),
    "<<": (">>",),
    ">>": ("<<",),
    "&": ("|",),
    "|": ("&",),
    "^": ("|",),
    "&&": ("||",),
    "||": ("&&",),
    "+=": ("-=",),
    "-=": ("+=",),
    "++": ("--",),
    "--": ("++",),
    "|=": ("&=",),
    "&=": ("|=",),
}
KINDS = {
    **dict.fromkeys(("<", "<=", ">", ">=", "==", "!="), "relation"),
    **dict.fromkeys(("&&", "||", "&", "|", "^", "|=", "&="), "logic"),
}
OPERATOR_NODES = ("binary_expression", "assignment_expression", "update_expression")
# Nothing in these is code.
SKIPPED = ("comment", "field_declaration", "enumerator_list", "preproc_include", "static_assert")
NUMBER = re.compile(r"(0[xX][0-9a-fA-F]+|[0-9]+)([uUlL]*)")


@dataclass(frozen=True)
class Mutant:
    path: str  # of the file, from the root of the project
    line: int  # from 1
    kind: str
    start: int  # bytes that are replaced
    end: int
    new: str
    key: str  # names it as long as its lines stay as they are, wherever they move

    def applied(self, source: bytes) -> bytes:
        return source[: self.start] + self.new.encode() + source[self.end :]


@dataclass(frozen=True)
class Change:
    kind: str
    node: Node
    new: str


@cache
def parser() -> Parser:
    return Parser(Language(tree_sitter_c.language()))


def text_of(node: Node) -> str:
    assert node.text is not None
    return node.text.decode()


def walk(node: Node) -> Iterator[Node]:
    """The code below a node, it included, in the order of the text."""
    if node.type in SKIPPED or text_of(node).startswith("_Static_assert"):
        return
    yield node
    for child in node.children:
        yield from walk(child)


def enums(sources: Sequence[bytes]) -> list[list[str]]:
    """The names of each enumeration. A count of them at its end is no value."""
    found = []
    for source in sources:
        stack = [parser().parse(source).root_node]
        while stack:
            node = stack.pop()
            stack.extend(node.children)
            if node.type == "enumerator_list":
                values = [one for one in node.children if one.type == "enumerator"]
                found.append([text_of(one.children[0]) for one in values if not is_count(one)])
    return found


def is_count(enumerator: Node) -> bool:
    return len(enumerator.children) == 1 and text_of(enumerator).endswith(("_COUNT", "S"))


def aliases(root: Node) -> dict[str, str]:
    """Names that a file's own #define gives to other names."""
    found = {}
    for node in root.children:
        if node.type == "preproc_def":
            value = node.child_by_field_name("value")
            name = node.child_by_field_name("name")
            if value is not None and name is not None and text_of(value).strip().isidentifier():
                found[text_of(name)] = text_of(value).strip()
    return found


def is_single_change(node: Node) -> bool:
    """Whether a return leaves early: the last one of a function has to stay."""
    block = node.parent
    if block is None or block.type == "case_statement":
        return block is not None
    if block.type != "compound_statement":
        return block.type in ("if_statement", "else_clause")
    return block.parent is not None and block.parent.type != "function_definition"


def operator_changes(node: Node) -> Iterator[Change]:
    if node.type in OPERATOR_NODES:
        operator = node.child_by_field_name("operator")
        if operator is not None:
            name = text_of(operator)
            for new in SWAPS.get(name, ()):
                yield Change(KINDS.get(name, "arithmetic"), operator, new)
    elif node.type == "unary_expression" and text_of(node.children[0]) in ("-", "!", "~"):
        yield Change("negation", node.children[0], "")


def neighbours(literal: str) -> tuple[str, ...]:
    """A whole number as one more and one less, of the same type; none of what is no such number."""
    found = NUMBER.fullmatch(literal)
    if found is None:
        return ()
    digits, suffix = found.groups()
    value = int(digits, 0) if digits.strip("0") else 0
    less = f"{value - 1}{suffix}" if value > 0 else f"(-1{suffix})"
    return f"{value + 1}{suffix}", less


def constant_changes(node: Node) -> Iterator[Change]:
    if node.type in ("number_literal", "preproc_arg"):
        for new in neighbours(text_of(node).strip()):
            yield Change("constant", node, new)
    elif node.type in ("true", "false"):
        yield Change("constant", node, "false" if node.type == "true" else "true")


def condition_changes(node: Node) -> Iterator[Change]:
    if node.type in ("if_statement", "while_statement", "conditional_expression"):
        condition = node.child_by_field_name("condition")
        if condition is not None:
            yield Change("condition", condition, f"(!({text_of(condition)}))")


def statement_changes(node: Node) -> Iterator[Change]:
    is_deleted = node.type in ("expression_statement", "break_statement") and text_of(node) != ";"
    if is_deleted or (node.type == "return_statement" and is_single_change(node)):
        yield Change("deletion", node, ";")


def entry_changes(
    node: Node, values: dict[str, list[str]], names: dict[str, str]
) -> Iterator[Change]:
    """Of a table: each entry that is a value of an enumeration, as each other value of it."""
    if node.type != "identifier" or node.parent is None or node.parent.type != "initializer_list":
        return
    name = names.get(text_of(node), text_of(node))
    for other in values.get(name, ()):
        if other != name:
            yield Change("entry", node, other)


def changes(root: Node, known: list[list[str]]) -> Iterator[Change]:
    values = {name: one for one in known for name in one}
    names = aliases(root)
    for node in walk(root):
        yield from operator_changes(node)
        yield from constant_changes(node)
        yield from condition_changes(node)
        yield from statement_changes(node)
        yield from entry_changes(node, values, names)


def function_of(node: Node) -> str:
    """The function that it is in, or the table."""
    above = node
    while above.parent is not None and above.parent.type != "translation_unit":
        above = above.parent
    declarator: Node | None = above
    while declarator is not None and declarator.type != "identifier":
        declarator = declarator.child_by_field_name("declarator")
    return "-" if declarator is None else text_of(declarator)


def lines_around(source: bytes, start: int, end: int) -> tuple[int, int]:
    first = source.rfind(b"\n", 0, start) + 1
    last = source.find(b"\n", end)
    return first, len(source) if last < 0 else last


def squeezed(code: bytes) -> str:
    return " ".join(code.decode().split())


def mutants_of(path: str, source: bytes, known: list[list[str]]) -> list[Mutant]:
    """All of a file, in the order of its text."""
    root = parser().parse(source).root_node
    found: dict[tuple[int, int, str], Mutant] = {}
    seen: Counter[str] = Counter()
    for change in changes(root, known):
        start, end = change.node.start_byte, change.node.end_byte
        if (start, end, change.new) in found:
            continue
        first, last = lines_around(source, start, end)
        new = source[first:start] + change.new.encode() + source[end:last]
        where = f"{path} {function_of(change.node)}"
        key = f"{where}: {squeezed(source[first:last])} => {squeezed(new)}"
        seen[key] += 1
        key += f" #{seen[key]}" if seen[key] > 1 else ""
        line = change.node.start_point.row + 1
        found[start, end, change.new] = Mutant(path, line, change.kind, start, end, change.new, key)
    return list(found.values())
