"""The mapping file of `--columns`: the keys of one [[set]] of a scoring file."""

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from quiesce.base.errors import UsageError, one_line
from quiesce.base.paths import shown
from quiesce.damper.data.condition import LOW_PASS_Hz, Settings
from quiesce.damper.data.read import Columns, OutputAverage
from quiesce.damper.data.split import Split, parse_part
from quiesce.recording.beside import given_columns, is_number
from quiesce.recording.table import clipped

# Of a scoring file: what a mapping has no use for.
_OF_SCORING = {"name", "file", "lagged_baseline"}
_FLAGS = ("flip_force", "split_gaps", "keep_offset", "use_velocity", "accept_values")
_NUMBERS = ("current_A", "rate_Hz", "low_pass_Hz", "drift_Hz", "work_rate_Hz")
_OTHERS = ("columns", "group", "output_average", "skip_lines", "train", "test")
KEYS = (*_OTHERS[:3], *_FLAGS, *_NUMBERS, *_OTHERS[3:])


@dataclass(frozen=True)
class Plan:
    """Everything about reading and conditioning that a file or the command line can state."""

    columns: Columns = field(default_factory=Columns)
    settings: Settings = field(default_factory=Settings)
    split: Split | None = None


def plan_of_mapping(table: Mapping[str, Any], where: str) -> Plan:
    """From the keys of one [[set]]; UsageError, beginning with `where`, for what is wrong."""
    for key in table:
        if key not in KEYS and key not in _OF_SCORING:
            raise UsageError(f"{where}: unknown key '{clipped(key)}'; known are {', '.join(KEYS)}")
    flags = {key: checked_flag(table, key, where) for key in _FLAGS if key in table}
    numbers = {key: checked_number(table, key, where) for key in _NUMBERS if key in table}
    columns = Columns(
        given=given_columns(table.get("columns", {}), where),
        rate_Hz=numbers.get("rate_Hz"),
        current_A=numbers.get("current_A"),
        flip_force=flags.get("flip_force", False),
        group=checked_group(table.get("group", []), where),
        average=checked_average(table.get("output_average"), where),
        split_gaps=flags.get("split_gaps", False),
        may_be_uneven="work_rate_Hz" in numbers,
        skip_lines=checked_lines(table.get("skip_lines", 0), where),
    )
    settings = Settings(
        low_pass_Hz=numbers.get("low_pass_Hz"),
        drift_Hz=numbers.get("drift_Hz"),
        work_rate_Hz=numbers.get("work_rate_Hz"),
        flipped=columns.flip_force,
        **{key: flags[key] for key in _FLAGS[2:] if key in flags},
    )
    return Plan(columns, settings, checked_split(table, where))


def checked_flag(table: Mapping[str, Any], key: str, where: str) -> bool:
    if not isinstance(table[key], bool):
        raise UsageError(f"{where}: {key} has to be true or false")
    return table[key]


def checked_number(table: Mapping[str, Any], key: str, where: str) -> float:
    value = table[key]
    if not is_number(value):
        raise UsageError(f"{where}: {key} has to be a number")
    if key != "current_A" and value <= 0.0:
        raise UsageError(f"{where}: {key} has to be above 0")
    return float(value)


def checked_lines(value: Any, where: str) -> int:
    if not isinstance(value, int) or isinstance(value, bool) or value < 0:
        raise UsageError(f"{where}: skip_lines has to be a whole number from 0 on")
    return value


def checked_group(value: Any, where: str) -> tuple[str, ...]:
    if not isinstance(value, list) or not all(isinstance(name, str) for name in value):
        raise UsageError(f"{where}: group has to be a list of column names")
    return tuple(value)


def checked_average(value: Any, where: str) -> OutputAverage | None:
    if value is None:
        return None
    expected = (
        f"{where}: output_average is {{ seconds = S }} or {{ periods = P, "
        "frequency_column = NAME }, with numbers above 0"
    )
    if not isinstance(value, Mapping) or set(value) not in (
        {"seconds"},
        {"periods", "frequency_column"},
    ):
        raise UsageError(expected)
    length = value.get("seconds", value.get("periods"))
    is_name = isinstance(value.get("frequency_column", ""), str)
    if not is_number(length) or length <= 0 or not is_name:
        raise UsageError(expected)
    return OutputAverage(**value)


def checked_split(table: Mapping[str, Any], where: str) -> Split | None:
    if "train" not in table and "test" not in table:
        return None
    if not ("train" in table and "test" in table):
        raise UsageError(f"{where}: train and test go together")
    parts = [parse_part(f"{where}: {key}", table[key]) for key in ("train", "test")]
    return Split(*parts)


def read_mapping(file: Path, data: list[Path]) -> Plan:
    """From a mapping file: its keys at the top, or as [[set]] tables of which the one for `data`
    is taken by the name of its file."""
    try:
        table = tomllib.loads(file.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or one_line(error)
        raise UsageError(f"{shown(file)}: {clipped(reason, 200)}; --columns takes a TOML file")
    if "set" not in table:
        return plan_of_mapping(table, shown(file))
    sets = table["set"]
    if not isinstance(sets, list) or not all(isinstance(one, dict) for one in sets) or not sets:
        raise UsageError(f"{shown(file)}: 'set' has to be a list of tables, [[set]]")
    names = {path.name for path in data}
    fitting = [one for one in sets if Path(str(one.get("file", ""))).name in names]
    chosen = sets if len(sets) == 1 else fitting
    if len(chosen) != 1:
        raise UsageError(
            f"{shown(file)}: {len(chosen)} of its {len(sets)} sets are for "
            f"{', '.join(sorted(names))}; copy the keys of one [[set]] into a file of its own"
        )
    low_pass_Hz = table.get("displacement_low_pass_Hz")
    plan = plan_of_mapping(chosen[0], shown(file))
    return with_low_pass(plan, low_pass_Hz, shown(file))


def with_low_pass(plan: Plan, low_pass_Hz: Any, where: str) -> Plan:
    """A scoring file's cut-off; the usual one is lowered where a test was sampled slowly."""
    if low_pass_Hz is None or plan.settings.low_pass_Hz is not None:
        return plan
    key = "displacement_low_pass_Hz"
    value = checked_number({key: low_pass_Hz}, key, where)
    if value == LOW_PASS_Hz:
        return plan
    return replace(plan, settings=replace(plan.settings, low_pass_Hz=value))
