"""Lines of C as they are written: nesting, fresh names, branches that come to the same."""

import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field

from quiesce.rules.integers.affine import Affine

INDENT = "    "


@dataclass
class CWriter:
    lines: list[str] = field(default_factory=list)
    depth: int = 0
    names: int = 0

    def line(self, text: str) -> None:
        self.lines.append(INDENT * self.depth + text)

    def indented(self) -> "Indent":
        return Indent(self)

    def fresh(self, prefix: str) -> str:
        self.names += 1
        return f"{prefix}{self.names}"

    def drop_unused(self, start: int) -> None:
        """Definitions that nothing after them in their block reads, from line `start` on."""
        for index in range(len(self.lines) - 1, start - 1, -1):
            found = re.match(r" *const u?int(?:32|64)_t (\w+) =", self.lines[index])
            if found and not any(
                re.search(rf"\b{found[1]}\b", line) for line in self.rest_of_block(index)
            ):
                del self.lines[index]

    def rest_of_block(self, index: int) -> Iterator[str]:
        depth = indentation(self.lines[index])
        for line in self.lines[index + 1 :]:
            if indentation(line) < depth:
                return
            yield line

    def named(self, text: str) -> Affine:
        """A C variable with this value."""
        name = self.fresh("s")
        self.line(f"const uint32_t {name} = {text};")
        return Affine(0, {name: 1})

    def branch(self, condition: str, yes: Callable[[], None], no: Callable[[], None]) -> None:
        """Both ways return. One way only where both do the same."""
        start = len(self.lines)
        no()
        otherwise = self.cut(start)
        yes()
        if self.lines[start:] == otherwise:
            return
        inside = [INDENT + line for line in self.cut(start)]
        self.line(f"if ({condition}) {{")
        self.lines += inside
        self.line("}")
        self.lines += otherwise

    def cut(self, start: int) -> list[str]:
        """Takes the lines from `start` on away."""
        taken = self.lines[start:]
        del self.lines[start:]
        return taken


class Indent:
    def __init__(self, writer: CWriter) -> None:
        self.writer = writer

    def __enter__(self) -> None:
        self.writer.depth += 1

    def __exit__(self, *_: object) -> None:
        self.writer.depth -= 1


def int_text(value: int) -> str:
    return "INT32_MIN" if value == -(2**31) else str(value)


def indentation(line: str) -> int:
    return len(line) - len(line.lstrip())
