"""`--format`: what the time histories that a command writes are for."""

import argparse

from quiesce.recording.write import FORMATS, require_writer


def add_format(
    parser: argparse.ArgumentParser | argparse._ArgumentGroup,
    what: str,
    default: str | None = "csv",
) -> None:
    """what: the files that are meant."""
    parser.add_argument(
        "--format", choices=FORMATS, default=default,
        help=f"of {what}: csv, mat (MATLAB), uff (universal file 58)"
        + (" (%(default)s)" if default else ""),
    )  # fmt: skip


def require_format(args: argparse.Namespace) -> None:
    """UsageError where --format cannot be written: to be called before the work."""
    if args.format:
        require_writer(f".{args.format}")
