"""What the subcommands that make an FMU share."""

import argparse
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from quiesce.base.errors import UsageError
from quiesce.base.paths import shown

if TYPE_CHECKING:
    from quiesce.fmu.library import Description


def add_packing(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--fmi", choices=["2", "3"], default="2", help="version of the standard (%(default)s)"
    )
    parser.add_argument(
        "-o", "--out", type=Path, required=True, metavar="FILE.fmu", help="file to write"
    )


def add_settings(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--set", action="append", default=[], metavar="NAME=VALUE",
        help="parameter of the controller, repeatable",
    )  # fmt: skip


def require_suffix(out: Path) -> None:
    from quiesce.fmu.pack import SUFFIX

    if out.suffix != SUFFIX:
        raise UsageError(f"-o {out}: the name of an FMU ends with {SUFFIX}")


def packed(
    args: argparse.Namespace, kind: str, words: Sequence[str], files: dict[str, Path], text: str
) -> int:
    """Makes the file and says what is in it."""
    from quiesce.fmu.pack import pack

    require_suffix(args.out)
    found = pack(kind, words, files, args.fmi, text, args.out)
    return say_packed(args.out, args.fmi, kind, found)


def say_packed(out: Path, fmi: str, kind: str, found: "Description") -> int:
    counts = [
        f"{sum(one.causality == causality for one in found.variables)} {causality}s"
        for causality in ("input", "output", "parameter")
    ]
    print(f"{shown(out)}: FMI {fmi}.0, {kind}, {', '.join(counts)}")
    return 0
