"""Tokens of a rule file, each with its place, and errors that name it."""

import math
import re
from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass

from quiesce.base.errors import UsageError

NAME = "name"
NUMBER = "number"
STRING = "string"
SYMBOL = "symbol"
END = "end"
UNCLOSED = "unclosed"  # the start of a comment or text without an end

MAX_NUMBER = 1e30  # magnitude; differences and products of two stay finite
SHOWN_CHARACTERS = 40
# "0..25" is a range, not "0." and ".25"; what follows at once must not be part of another number.
NUMBER_PATTERN = (
    r"[+-]?(?:[0-9]+(?:\.(?!\.)[0-9]*)?|\.[0-9]+)(?:[eE][+-]?[0-9]+)?"
    r"(?![A-Za-z0-9_+-])(?!\.[0-9])"
)
# Where a format has infinities; only some shapes take them.
INFINITE_PATTERN = r"[+-]?[Ii]nf(?![A-Za-z0-9_])"
WORD_PATTERN = r"[A-Za-z_][A-Za-z0-9_]*"


@dataclass(frozen=True)
class Token:
    """kind: one of the above; offset: of its first character in the text."""

    kind: str
    text: str
    offset: int

    def shown(self) -> str:
        if self.kind == END:
            return self.text
        short = self.text[:SHOWN_CHARACTERS]
        return f"'{short}{'...' if short != self.text else ''}'"


class Source:
    """A text with its name; lines and columns count from 1."""

    def __init__(self, name: str, text: str) -> None:
        self.name = name
        self.text = text.replace("\r\n", "\n").replace("\r", "\n")
        self.starts = [0, *(match.end() for match in re.finditer("\n", self.text))]
        self.refuse_binary()

    def refuse_binary(self) -> None:
        found = re.search(r"[\x00-\x08\x0b\x0e-\x1f\x7f\ud800-\udfff]", self.text)
        if found:
            code = ord(found.group())
            raise self.error(found.start(), f"character U+{code:04X}", "a text file")

    def error(self, at: Token | int, what: str, expected: str = "") -> UsageError:
        """`FILE:LINE:COLUMN: what, expected ...`."""
        offset = at if isinstance(at, int) else at.offset
        line = bisect_right(self.starts, offset)
        place = f"{self.name}:{line}:{offset - self.starts[line - 1] + 1}"
        return UsageError(f"{place}: {what}{f', expected {expected}' if expected else ''}")

    def lines(self) -> list[tuple[int, int]]:
        """Offsets of the start and the end (without its newline) of each line."""
        ends = [*(start - 1 for start in self.starts[1:]), len(self.text)]
        return list(zip(self.starts, ends, strict=True))

    def number(self, token: Token, or_infinite: bool = False) -> float:
        """Finite, of bounded magnitude; the sign of zero is dropped."""
        value = float(token.text)
        if or_infinite and re.fullmatch(INFINITE_PATTERN, token.text):
            return value
        if not math.isfinite(value) or abs(value) > MAX_NUMBER:
            raise self.error(token, f"number {token.shown()}", f"one within +-{MAX_NUMBER:g}")
        return value + 0.0


def scan(source: Source, pattern: re.Pattern[str], start: int, end: int) -> list[Token]:
    """Tokens of text[start:end] and one of kind END.

    The pattern's groups are named after the kinds; what it matches outside of them is skipped.
    """
    tokens = []
    offset = start
    while offset < end:
        match = pattern.match(source.text, offset, end)
        if not match:
            word = Token(SYMBOL, re.split(r"\s", source.text[offset:end])[0], offset)
            raise source.error(word, f"found {word.shown()}", "a name, a number or a symbol")
        if match.lastgroup == UNCLOSED:
            raise source.error(offset, "a comment or text begins and never ends", "its end")
        if match.lastgroup:
            tokens.append(Token(match.lastgroup, match.group(match.lastgroup), offset))
        offset = match.end()
    last = "the end of the file" if end == len(source.text) else "the end of the line"
    return [*tokens, Token(END, last, end)]


class Stream:
    """Tokens one after another."""

    def __init__(self, source: Source, tokens: Sequence[Token], ignore_case: bool = False) -> None:
        self.source = source
        self.tokens = tokens
        self.ignore_case = ignore_case
        self.at = 0

    @property
    def token(self) -> Token:
        return self.tokens[self.at]

    def take(self) -> Token:
        token = self.token
        if token.kind != END:
            self.at += 1
        return token

    def sees(self, *texts: str) -> bool:
        """Whether the next token is one of these words or symbols."""
        if self.token.kind not in (NAME, SYMBOL):
            return False
        text = self.token.text.upper() if self.ignore_case else self.token.text
        return text in texts

    def accept(self, *texts: str) -> Token | None:
        return self.take() if self.sees(*texts) else None

    def expect(self, *texts: str, after: str = "") -> Token:
        if not self.sees(*texts):
            raise self.unexpected(" or ".join(f"'{text}'" for text in texts) + after)
        return self.take()

    def expect_kind(self, kind: str, what: str) -> Token:
        if self.token.kind != kind:
            raise self.unexpected(what)
        return self.take()

    def number(self, what: str = "a number", or_infinite: bool = False) -> float:
        return self.source.number(self.expect_kind(NUMBER, what), or_infinite)

    def unexpected(self, expected: str) -> UsageError:
        return self.source.error(self.token, f"found {self.token.shown()}", expected)


def number_text(value: float) -> str:
    """The shortest decimal that reads as this number."""
    text = repr(float(value) + 0.0)
    return text.removesuffix(".0")


def check_identifier(name: str, what: str, format_name: str, reserved: set[str]) -> None:
    """For writers: UsageError where the format cannot hold this name."""
    if not re.fullmatch(WORD_PATTERN, name):
        raise UsageError(
            f"{what} '{name}': {format_name} names have letters, digits and _ and begin with no "
            "digit; rename it"
        )
    if name in reserved:
        raise UsageError(f"{what} '{name}' is a word of {format_name}; rename it")
