"""What a viewer asks of the recorder: docs/reference/live-protocol.md."""

from dataclasses import dataclass
from typing import Any

FORMATS = ("mf4", "csv")
MOST_BEFORE_S = 30.0
MOST_S = 3600.0
MOST_TEXT = 120  # letters of a marker
NOW, FAULT, STATE, LEVEL = TRIGGERS = ("now", "fault", "state", "level")
KEYS = {"format", "before_s", "after_s", "trigger"}


@dataclass(frozen=True)
class Trigger:
    """What a recording waits for. level: of the integers on the wire; is_above: it is passed
    upwards, else downwards."""

    on: str
    series: int = -1
    level: float = 0.0
    is_above: bool = True


@dataclass(frozen=True)
class RecordPlan:
    """before_s: how much of what was before the trigger is in the file; after_s: how long it
    goes on after it, 0: until somebody ends it."""

    format: str
    before_s: float
    after_s: float
    trigger: Trigger


def record_plan_of(said: dict[str, Any], series_count: int) -> RecordPlan:
    """ValueError, with what would be allowed, where it is none."""
    if said["format"] not in FORMATS:
        raise ValueError(f"'format' is none of {', '.join(FORMATS)}")
    return RecordPlan(
        format=said["format"],
        before_s=number_of(said, "before_s", 0.0, MOST_BEFORE_S),
        after_s=number_of(said, "after_s", 0.0, MOST_S),
        trigger=trigger_of(said["trigger"], series_count),
    )


def trigger_of(said: Any, series_count: int) -> Trigger:
    on = said.get("on") if isinstance(said, dict) else None
    if on not in TRIGGERS:
        raise ValueError(f"'trigger' is an object whose 'on' is one of {', '.join(TRIGGERS)}")
    if set(said) != {"on"} | ({"series", "level", "is_above"} if on == LEVEL else set()):
        raise ValueError(f"trigger '{on}' has other keys than it may have")
    if on != LEVEL:
        return Trigger(on)
    series, is_above = said["series"], said["is_above"]
    if type(series) is not int or not 0 <= series < series_count or type(is_above) is not bool:
        raise ValueError("'series' is the number of a series, 'is_above' true or false")
    return Trigger(on, series, number_of(said, "level", -(2.0**32), 2.0**32), is_above)


def number_of(said: dict[str, Any], key: str, least: float, most: float) -> float:
    value = said[key]
    if type(value) not in (int, float) or not least <= value <= most:  # NaN is in no range
        raise ValueError(f"'{key}' is a number in {least:g} .. {most:g}")
    return float(value)


def marker_of(value: Any) -> str:
    """One line of text that a person can read."""
    text = value.strip() if isinstance(value, str) else ""
    if not 0 < len(text) <= MOST_TEXT or not text.isprintable():
        raise ValueError(f"'text' is a line of 1 .. {MOST_TEXT} letters")
    return text
