"""Data options of `quiesce identify`, and the records that they ask for."""

import argparse
from dataclasses import replace
from pathlib import Path
from typing import Any

from quiesce.base.errors import Problems, UsageError
from quiesce.damper.data.mapping import Plan, read_mapping
from quiesce.damper.data.read import Columns, OutputAverage
from quiesce.damper.data.records import Conditioned, conditioned
from quiesce.damper.data.split import Split, part_from_text
from quiesce.recording.columns import NONE, OF_DAMPERS, parse_spec

_SETTING_FLAGS = ("keep_offset", "use_velocity", "accept_values")


def positive(text: str) -> float:
    value = float(text)
    if not 0.0 < value < float("inf"):
        raise ValueError
    return value


def whole_number(text: str) -> int:
    value = int(text)
    if value < 0:
        raise ValueError
    return value


def numbers(text: str) -> list[float]:
    values = [float(word) for word in text.split(",")]
    if not all(abs(value) < float("inf") for value in values):
        raise ValueError
    return values


def add_data_options(group: argparse._ArgumentGroup) -> None:
    """Options that `records_of` reads; the files themselves are the command's own."""
    group.add_argument(
        "--columns", type=Path, metavar="FILE.toml",
        help="mapping file; what is given on the command line wins",
    )  # fmt: skip
    for role in OF_DAMPERS:
        group.add_argument(
            f"--{role}", dest=f"column_{role}", metavar="NAME[:UNIT]",
            help=f"column of {role} (found by its name), or 'none'",
        )  # fmt: skip
    group.add_argument("--rate-hz", type=positive, metavar="Hz", help="rate, without time column")
    group.add_argument(
        "--current-a", type=numbers, metavar="A[,A]",
        help="constant current, one for all files or one a file",
    )  # fmt: skip
    group.add_argument("--flip-force", action="store_true", help="turn the sign of the force")
    group.add_argument(
        "--group", action="append", default=[], metavar="NAME[,NAME]",
        help="columns whose values tell the tests in a file apart",
    )  # fmt: skip
    group.add_argument(
        "--output-average", metavar="S|PERIODS:COLUMN",
        help="moving average that the force went through: seconds, or periods of the frequency "
        "in a column",
    )  # fmt: skip
    group.add_argument("--split-gaps", action="store_true", help="a record on each side of a gap")
    group.add_argument(
        "--skip-lines", type=whole_number, metavar="N", help="lines above the header"
    )
    add_condition_options(group)
    for name in ("--train", "--test"):
        group.add_argument(
            name, metavar="FORM=A,B", dest=f"part_{name[2:]}",
            help="rows to fit or to hold out: time_s, part (0 .. 1), rows or current_A",
        )  # fmt: skip


def add_condition_options(group: argparse._ArgumentGroup) -> None:
    for name, text in (
        ("--low-pass-hz", "cut-off of the displacement (40, less where sampled slowly)"),
        ("--drift-hz", "high-pass where velocity is integrated (0.2)"),
        ("--work-rate-hz", "rate of the records (the file's, or a part of it)"),
    ):
        group.add_argument(name, type=positive, metavar="Hz", help=text)
    for name, text in (
        ("--keep-offset", "do not remove the mean displacement"),
        ("--use-velocity", "use the measured velocity, not dx/dt"),
        ("--accept-values", "values that look like a wrong unit are right"),
    ):
        group.add_argument(name, action="store_true", help=text)


def plan_of(args: argparse.Namespace, files: list[Path]) -> Plan:
    """The mapping file's plan with the command line on top."""
    plan = read_mapping(args.columns, files) if args.columns else Plan()
    stated = {
        "low_pass_Hz": args.low_pass_hz,
        "drift_Hz": args.drift_hz,
        "work_rate_Hz": args.work_rate_hz,
        **{name: getattr(args, name) or None for name in _SETTING_FLAGS},
    }
    settings = replace(plan.settings, **given_only(stated))
    columns = columns_of(args, plan.columns)
    columns = replace(columns, may_be_uneven=settings.work_rate_Hz is not None)
    settings = replace(settings, flipped=columns.flip_force)
    return Plan(columns, settings, split_of(args, plan.split))


def columns_of(args: argparse.Namespace, from_file: Columns) -> Columns:
    given = dict(from_file.given)
    problems = Problems()
    for role in OF_DAMPERS:
        if text := getattr(args, f"column_{role}"):
            with problems.told():
                given[role] = None if text == NONE else parse_spec(role, text)
    problems.refuse()
    stated = {
        "rate_Hz": args.rate_hz,
        "flip_force": args.flip_force or None,
        "split_gaps": args.split_gaps or None,
        "skip_lines": args.skip_lines,
        "group": tuple(name.strip() for item in args.group for name in item.split(",")) or None,
        "average": average_from_text(args.output_average) if args.output_average else None,
    }
    return replace(from_file, given=given, **given_only(stated))


def given_only(values: dict[str, Any]) -> dict[str, Any]:
    return {key: value for key, value in values.items() if value is not None}


def split_of(args: argparse.Namespace, from_file: Split | None) -> Split | None:
    if (args.part_train is None) != (args.part_test is None):
        raise UsageError("--train and --test go together")
    if args.part_train is None:
        return from_file
    return Split(
        part_from_text("--train", args.part_train), part_from_text("--test", args.part_test)
    )


def average_from_text(text: str) -> OutputAverage:
    length, _, column = text.partition(":")
    try:
        value = positive(length)
    except ValueError:
        raise UsageError(
            f"--output-average '{text}': write seconds, such as 0.02, or periods and the column "
            "of the frequency, such as 0.1:freq_hz"
        )
    return OutputAverage(value, column) if column else OutputAverage(seconds=value)


def records_of(args: argparse.Namespace, files: list[Path] | None = None) -> Conditioned:
    """Records of `files` (args.files unless given). UsageError for bad input."""
    files = list(args.files if files is None else files)
    return conditioned(files, plan_of(args, files), args.current_a)
