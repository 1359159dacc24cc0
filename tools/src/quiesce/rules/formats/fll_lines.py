"""The lines of an FLL file, `key: value`, sorted into its sections."""

import re
from collections.abc import Sequence
from dataclasses import dataclass, field

from quiesce.rules.formats.scan import NAME, Source, Token

LINE = re.compile(r"[ \t]*(?P<key>[A-Za-z][A-Za-z-]*)[ \t]*:[ \t]*")
ENGINE, INPUT, OUTPUT, BLOCK = "Engine", "InputVariable", "OutputVariable", "RuleBlock"
# description is for people; lock-range makes no difference inside the range, to which inputs
# clamp here in any case.
IGNORED = ("description", "lock-range")
KEYS = {
    ENGINE: ("description",),
    INPUT: (*IGNORED, "enabled", "range", "term"),
    OUTPUT: (
        *IGNORED, "enabled", "range", "term", "aggregation", "defuzzifier", "default",
        "lock-previous",
    ),
    BLOCK: (
        "description", "enabled", "conjunction", "disjunction", "implication", "activation", "rule",
    ),
}  # fmt: skip
REPEATED = ("term", "rule")


@dataclass(frozen=True)
class Line:
    """`key: value`; start: of the value, end: of the line less its comment."""

    key: Token
    start: int
    end: int


@dataclass
class Section:
    head: Line
    lines: list[Line] = field(default_factory=list)


def split_lines(source: Source) -> list[Line]:
    """Those with content."""
    found = []
    for start, line_end in source.lines():
        text = source.text[start:line_end].split("#")[0].rstrip()
        if not text:
            continue
        end = start + len(text)
        match = LINE.match(source.text, start, end)
        if not match:
            first = start + len(text) - len(text.lstrip())
            word = Token(NAME, text.strip(), first)
            raise source.error(first, f"found {word.shown()}", "'key: value'")
        found.append(Line(Token(NAME, match["key"], match.start("key")), match.end(), end))
    return found


def split_sections(source: Source, lines: Sequence[Line]) -> list[Section]:
    sections: list[Section] = []
    for line in lines:
        if sections and line.key.text == ENGINE:
            raise source.error(line.key, "a second Engine", "one in a file")
        if line.key.text in KEYS:
            sections.append(Section(line))
        elif not sections:
            raise source.error(line.key, f"found {line.key.shown()}", "'Engine: name' first")
        else:
            add_line(source, sections[-1], line)
    return sections


def add_line(source: Source, section: Section, line: Line) -> None:
    kind, key = section.head.key.text, line.key
    if key.text not in KEYS[kind]:
        allowed = ", ".join(KEYS[kind])
        raise source.error(key, f"no key {key.shown()} of {kind}", f"one of {allowed}")
    if key.text not in REPEATED and key.text in (other.key.text for other in section.lines):
        raise source.error(key, f"{key.shown()} again", "it once")
    section.lines.append(line)
