"""Which rows are fitted and which are held out."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from quiesce.base.errors import UsageError
from quiesce.damper.data.record import Record
from quiesce.recording.beside import is_number

FORMS = ("time_s", "part", "rows", "current_A")


def same_within(level: float) -> float:
    """How far measured commands of one level may lie apart, in A (V)."""
    return max(0.02 * abs(level), 0.01)


@dataclass(frozen=True)
class Segment:
    """Rows first .. end - 1 of a record are scored; a model runs from the record's row 0 on."""

    record: Record
    first: int
    end: int

    def __len__(self) -> int:
        return self.end - self.first

    @property
    def rows(self) -> slice:
        return slice(self.first, self.end)


@dataclass(frozen=True)
class Part:
    """One form of FORMS: a half-open range of seconds, of parts 0 .. 1 or of the file's rows in
    each test, or the commands of the tests that are meant (A, or V as they stand)."""

    form: str
    values: tuple[float, ...]

    def segments(self, records: Sequence[Record]) -> list[Segment]:
        if self.form == "current_A":
            return [whole(record) for record in records if self.has_level(record)]
        cuts = [Segment(record, *self.range_of(record)) for record in records]
        return [cut for cut in cuts if len(cut) > 0]

    def has_level(self, record: Record) -> bool:
        level = record.level
        return level is not None and any(
            abs(level - value) <= same_within(value) for value in self.values
        )

    def range_of(self, record: Record) -> tuple[int, int]:
        if self.form == "time_s":
            # Half a sample of tolerance: stamps are rounded.
            edges = np.array(self.values) - 0.5 / record.rate_Hz
            first, end = np.searchsorted(record.time_s, edges)
        elif self.form == "part":
            first, end = (round(value * len(record)) for value in self.values)
        else:
            first, end = (int(np.ceil(value / record.file_rows)) for value in self.values)
        return min(int(first), len(record)), min(int(end), len(record))

    def __str__(self) -> str:
        return f"{self.form} = {', '.join(f'{value:g}' for value in self.values)}"


@dataclass(frozen=True)
class Split:
    train: Part
    test: Part


def whole(record: Record) -> Segment:
    return Segment(record, 0, len(record))


def parse_part(where: str, table: Any) -> Part:
    """From { FORM = [values] }. UsageError otherwise."""
    if not isinstance(table, Mapping) or len(table) != 1 or next(iter(table)) not in FORMS:
        raise UsageError(f"{where}: expected one of {', '.join(FORMS)}, such as part = [0, 0.5]")
    form, values = next(iter(table.items()))
    if not isinstance(values, list | tuple) or not values or not all(map(is_number, values)):
        raise UsageError(f"{where}: {form} has to be a list of numbers")
    if form != "current_A" and not (len(values) == 2 and 0.0 <= values[0] < values[1]):
        raise UsageError(f"{where}: {form} has to be a range from 0 on, [FROM, TO]")
    if form == "part" and values[1] > 1.0:
        raise UsageError(f"{where}: part goes from 0 to 1")
    return Part(form, tuple(float(value) for value in values))


def part_from_text(option: str, text: str) -> Part:
    """FORM=A,B as typed after --train or --test."""
    form, _, values = text.partition("=")
    try:
        numbers = [float(value) for value in values.split(",")]
    except ValueError:
        numbers = []
    if form not in FORMS or not numbers:
        raise UsageError(
            f"{option} '{text}': write one of {', '.join(FORMS)} with its values, "
            "such as part=0,0.5"
        )
    return parse_part(option, {form: numbers})


def split_records(
    records: Sequence[Record], spec: Split | None
) -> tuple[list[Segment], list[Segment]]:
    """Training and test segments. Without `spec` all is for training. UsageError where a part is
    empty or both share rows."""
    if spec is None:
        return [whole(record) for record in records], []
    train, test = spec.train.segments(records), spec.test.segments(records)
    for name, part, found in (("train", spec.train, train), ("test", spec.test, test)):
        if not found:
            raise UsageError(
                f"no row lies in the {name} part, {part}; the tests hold: {extent(records)}"
            )
    for one in train:
        for other in test:
            shared = min(one.end, other.end) - max(one.first, other.first)
            if one.record is other.record and shared > 0:
                raise UsageError(
                    f"train ({spec.train}) and test ({spec.test}) share {shared} rows of "
                    f"{one.record.name}; make them apart"
                )
    return train, test


def extent(records: Sequence[Record]) -> str:
    first = min(float(record.time_s[0]) for record in records)
    last = max(float(record.time_s[-1]) for record in records)
    rows = max(round(len(record) * record.file_rows) for record in records)
    levels = levels_of([whole(record) for record in records])
    commands = ", ".join(f"{level:g}" for level in levels) or "switched"
    return f"{first:g} .. {last:g} s, up to {rows} rows, command {commands}"


def records_in(segments: Sequence[Segment]) -> list[Record]:
    """Their records, each once."""
    return list({id(segment.record): segment.record for segment in segments}.values())


def is_switched(segments: Sequence[Segment]) -> bool:
    """The command changes within some test."""
    return any(segment.record.level is None for segment in segments)


def levels_of(segments: Sequence[Segment]) -> list[float]:
    """The distinct constant commands, rising; tests with a switched command have none."""
    found = sorted(level for segment in segments if (level := segment.record.level) is not None)
    return [
        level
        for i, level in enumerate(found)
        if i == 0 or level - found[i - 1] > same_within(level)
    ]
