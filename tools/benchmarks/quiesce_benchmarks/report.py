"""What every `./tools/benchmark NAME` reports: figures with goals, what could not be measured."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

from quiesce.base.errors import EXIT_FAILED
from quiesce.base.table import format_table

# A goal that could not be judged: its data or its tool is not on this machine.
EXIT_ABSENT = 3


@dataclass(frozen=True)
class Figure:
    name: str
    value: float | None  # None: not measured
    unit: str
    goal: float | None  # None: reported only
    better: str  # "lower" or "higher"
    is_gated: bool = True  # False: a time, judged but never failing a check

    @property
    def is_ok(self) -> bool | None:
        """Whether the goal is met; None where there is no goal or nothing to judge."""
        if self.goal is None or self.value is None:
            return None
        is_met = self.value <= self.goal if self.better == "lower" else self.value >= self.goal
        return bool(is_met)

    @property
    def is_absent(self) -> bool:
        return self.goal is not None and self.value is None

    def json_object(self) -> dict[str, Any]:
        gated = {} if self.is_gated else {"gated": False}
        return {
            "name": self.name,
            "value": rounded(self.value),
            "unit": self.unit,
            "goal": self.goal,
            "better": self.better,
            "ok": self.is_ok,
            **gated,
        }


@dataclass(frozen=True)
class Report:
    name: str  # of the benchmark
    figures: Sequence[Figure]
    context: dict[str, Any]  # what it was measured on; values of JSON
    tables: Sequence[str] = ()  # for people, below the figures
    absent: Sequence[str] = field(default_factory=tuple)  # why a figure has no value, one line each

    def json_object(self) -> dict[str, Any]:
        return {
            "bench": self.name,
            "figures": [figure.json_object() for figure in self.figures],
            "context": {**rounded(self.context), "absent": list(self.absent)},
        }

    def text(self) -> str:
        return "\n\n".join([figure_table(self.figures), *self.tables, *self.absent])

    def exit_code(self, is_checked: bool) -> int:
        """0, or with --check 1 where a goal is missed, else 3 where one could not be judged."""
        if not is_checked:
            return 0
        gated = [figure for figure in self.figures if figure.is_gated]
        if any(figure.is_ok is False for figure in gated):
            return EXIT_FAILED
        return EXIT_ABSENT if any(figure.is_absent for figure in gated) else 0


def rounded(value: Any) -> Any:
    """Six significant digits; containers are copied. What is not a finite number becomes None."""
    if isinstance(value, dict):
        return {key: rounded(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [rounded(item) for item in value]
    if value is None or isinstance(value, bool | int | str):
        return value
    number = float(value)
    return float(f"{number:.6g}") if math.isfinite(number) else None


def number_text(value: float | None) -> str:
    return "-" if value is None else f"{value:.6g}"


def figure_table(figures: Sequence[Figure]) -> str:
    marks = {True: "ok", False: "MISSED", None: ""}
    signs = {"lower": "<=", "higher": ">="}
    rows = [
        [
            figure.name,
            "absent" if figure.value is None else f"{figure.value:.4g}",
            "" if figure.unit == "1" else figure.unit,
            "" if figure.goal is None else f"{signs[figure.better]} {figure.goal:g}",
            "not judged" if figure.is_absent else marks[figure.is_ok],
        ]
        for figure in figures
    ]
    return format_table(["figure", "value", "unit", "goal", ""], rows, left=(0, 2, 4))
