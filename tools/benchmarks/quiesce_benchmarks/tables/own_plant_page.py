"""The commands of docs/howto/own-plant.md, for any of its structures."""

import re
import shlex
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache

from quiesce.base.errors import BenchFailure
from quiesce.base.paths import root

PAGE = "docs/howto/own-plant.md"
BLOCK = re.compile(r"```(\w+)\n(.*?)```", re.DOTALL)
SHOWN = "press"  # the structure that the page goes through with
PROGRAMS = {"../tools/quiesce": [], "../tools/hil": ["hil"]}


def blocks(text: str, kind: str) -> Iterator[str]:
    return (found for name, found in BLOCK.findall(text) if name == kind)


def commands(text: str) -> Iterator[list[str]]:
    """Words behind `quiesce` of every line of a page's shell blocks."""
    for block in blocks(text, "sh"):
        for line in block.replace("\\\n", " ").splitlines():
            program, *words = shlex.split(line, comments=True) or [""]
            if program in PROGRAMS:
                yield [*PROGRAMS[program], *words]


@dataclass(frozen=True)
class Page:
    damper: str  # the file small.toml
    new: dict[str, list[str]]  # words that make each structure, by name
    search: list[str]  # these are of SHOWN
    run_rules: list[str]
    tune: list[str]
    run_pulses: list[str]
    load_rules: list[str]
    load_pulses: list[str]


def read_page(text: str) -> Page:
    """BenchFailure where it does not go all the way."""
    found = list(commands(text))

    def first(*words: str) -> list[str]:
        for one in found:
            if set(words) <= set(one):
                return one
        raise BenchFailure(f"{PAGE} has no command with {' '.join(words)}")

    load = [without_bus(first("can", "load", kind, "--save")) for kind in ("rules", "pulses")]
    return Page(
        next(one for one in blocks(text, "toml") if one.startswith("# small.toml")),
        {one[2]: one for one in found if one[:2] == ["new", "plant"]},
        first("rules", "optimize"),
        first("hil", "--rules"),
        first("tune"),
        first("hil", "--pulses"),
        *load,
    )


@cache
def page() -> Page:
    return read_page((root() / PAGE).read_text(encoding="utf-8"))


def without_bus(words: list[str]) -> list[str]:
    return words[: words.index("--bus")]


def of_structure(words: list[str], name: str) -> list[str]:
    """What the page says of SHOWN, of another one."""
    return [re.sub(rf"^{SHOWN}(?=/|$)", name, word) for word in words]


def with_value(words: list[str], option: str, value: str) -> list[str]:
    """With another value of an option, or with it."""
    if option not in words:
        return [*words, option, value]
    at = words.index(option)
    return [*words[: at + 1], value, *words[at + 2 :]]
