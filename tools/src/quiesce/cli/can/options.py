"""Options that several actions of `quiesce can` share."""

import argparse
import math
from pathlib import Path

from quiesce.base.errors import UsageError
from quiesce.can.database import Database, load


def add_database_option(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--dbc", type=Path, metavar="FILE", help="another DBC (the shipped one)")


def database_of(args: argparse.Namespace) -> Database:
    return load(args.dbc)


def add_only_option(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--only", metavar="MESSAGES", help="names or hexadecimal ids with commas, e.g. Status,0x108"
    )


def ids_of(words: str | None, database: Database) -> set[int] | None:
    """Ids of messages by name or number; None: all. UsageError for what is neither."""
    if words is None:
        return None
    return {id_of(word.strip(), database) for word in words.split(",")}


def id_of(word: str, database: Database) -> int:
    if word in database.by_name:
        return database.by_name[word].frame_id
    try:
        return int(word.removeprefix("0x"), 16)
    except ValueError:
        names = ", ".join(one.name for one in database.messages if not one.is_lockstep)
        raise UsageError(f"--only {word}: no such message; there are {names}, or ids like 0x100")


def check_seconds(option: str, value_s: float) -> None:
    """UsageError where it is no duration."""
    if not (math.isfinite(value_s) and value_s > 0.0):
        raise UsageError(f"{option} {value_s:g}: seconds, above 0")
