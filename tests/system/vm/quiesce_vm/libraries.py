"""Which shared libraries a program for arm64 needs, from folders of unpacked Debian packages."""

import re
import subprocess
from pathlib import Path

from quiesce.base.errors import UsageError

FOLDERS = ("lib/aarch64-linux-gnu", "usr/lib/aarch64-linux-gnu", "lib")
_NEEDED = re.compile(r"\(NEEDED\).*\[(.+)\]")


def closure(root: Path, programs: list[Path], extra: tuple[Path, ...] = ()) -> dict[str, Path]:
    """Name and file of every library that the programs need, directly or not.

    extra: folders to look in before those of `root`. UsageError where one is missing.
    """
    folders = (*extra, *(root / folder for folder in FOLDERS))
    found: dict[str, Path] = {}
    todo = [(program, name) for program in programs for name in needed(program)]
    while todo:
        user, name = todo.pop()
        if name in found:
            continue
        file = next((folder / name for folder in folders if (folder / name).exists()), None)
        if file is None:
            raise UsageError(
                f"{user.name} needs {name}, which is in no arm64 package at hand; "
                "add its package to tests/system/vm/images.sh"
            )
        found[name] = file
        todo += [(file, next_name) for next_name in needed(file)]
    return found


def needed(program: Path) -> list[str]:
    """Libraries that the file itself names; none for a static program."""
    command = ["aarch64-linux-gnu-readelf", "--dynamic", "--wide", str(program)]
    try:
        result = subprocess.run(command, capture_output=True, text=True)
    except FileNotFoundError:
        raise UsageError(f"{command[0]} is missing: run tests/system/vm/build_images")
    if result.returncode != 0:
        raise UsageError(f"{program} is not a program for Linux: {result.stderr.strip()}")
    return _NEEDED.findall(result.stdout)
