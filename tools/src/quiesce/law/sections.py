"""Tables whose own part is a section for each damper, from the first on.

firmware/base/sections.h describes their words.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import ClassVar, Generic, Protocol, TypeVar

import numpy as np

from quiesce.law.signal import Input, Signal
from quiesce.table.words import Reader, opened, sealed

MOST_SECTIONS = 4


class Named(Protocol):
    @property
    def signal(self) -> Signal: ...


class Section(Protocol):
    @property
    def inputs(self) -> Sequence[Named]: ...

    def words(self) -> list[int]:
        """ValueError where there is too much of it."""
        ...

    def currents_A(self, values: np.ndarray) -> np.ndarray:
        """[ticks] for its inputs [ticks, inputs] in SI units, in float64."""
        ...


S = TypeVar("S", bound=Section)


@dataclass(frozen=True)
class CurrentSections(Generic[S]):
    """A table of sections that demand currents."""

    sections: tuple[S, ...]

    magic: ClassVar[int]
    law: ClassVar[str]
    demands: ClassVar[str] = "current"

    def signals(self) -> list[Signal]:
        return [one.signal for section in self.sections for one in section.inputs]

    def dampers(self) -> set[int]:
        return set(range(len(self.sections)))

    def words(self) -> list[int]:
        """ValueError where there is too much of it."""
        return sealed_sections(self.magic, [one.words() for one in self.sections], "table")

    def currents_A(self, values: np.ndarray) -> np.ndarray:
        """Of each damper [ticks 4] for signals [ticks, as signals() lists them] in SI units, in
        float64."""
        out = np.zeros((len(values), MOST_SECTIONS))
        first = 0
        for i, section in enumerate(self.sections):
            last = first + len(section.inputs)
            out[:, i] = section.currents_A(values[:, first:last])
            first = last
        return out


T = TypeVar("T")


def sealed_sections(magic: int, sections: Sequence[Sequence[int]], what: str) -> list[int]:
    """A whole table of words, signed or not. ValueError, in one line, where it is more than a
    controller takes; `what` is what it is called there."""
    if not 1 <= len(sections) <= MOST_SECTIONS:
        raise ValueError(f"{len(sections)} dampers; a {what} is of 1 .. {MOST_SECTIONS}")
    return sealed(magic, [len(sections), *(word for section in sections for word in section)])


def read_kind(
    magic: int, words: Sequence[int], read_one: Callable[[Reader], T], what: str
) -> tuple[T, ...]:
    """As read_sections, of a table that has to be of this kind."""
    opened(words)
    if words[0] != magic:
        raise ValueError(f"it begins with 0x{words[0]:08x}, a {what} with 0x{magic:08x}")
    return read_sections(words, read_one)


def read_sections(words: Sequence[int], read_one: Callable[[Reader], T]) -> tuple[T, ...]:
    """ValueError, in one line, where the firmware refuses them."""
    reader = Reader(opened(words))
    count = reader.one(1, MOST_SECTIONS, "number of dampers")
    sections = tuple(read_one(reader) for _ in range(count))
    reader.end()
    return sections


def limited(inputs: Sequence[Input], values: np.ndarray) -> np.ndarray:
    """What a table works with: values [ticks, inputs] in SI units as its inputs, limited."""
    scale = np.array([one.per_unit for one in inputs])
    largest = np.array([one.largest for one in inputs])
    return np.clip(values * scale, -largest, largest)
