"""The images that only benchmarks run: built where they are missing, and counted."""

import os
import subprocess
import sys
from functools import cache
from pathlib import Path
from typing import Any

from quiesce.base.errors import EXIT_BAD_INPUT, BenchFailure, UsageError
from quiesce.base.paths import build_folder, root
from quiesce.engine.bench import Bench, ending, require_file


def built_image(name: str) -> Path:
    """build/mps2/tools/benchmarks/NAME.elf, up to date. With QUIESCE_BUILD set: as it is there.

    UsageError where it cannot be had: the network, a tool.
    """
    if not os.environ.get("QUIESCE_BUILD"):
        build("tools/benchmarks/build_images", name)
    return require_file(build_folder() / f"mps2/tools/benchmarks/{name}.elf", "the image")


@cache
def build(script: str, name: str) -> None:
    """Builds it with that script of the project, and fetches what it needs where it is a peer.

    Its progress goes to stderr.
    """
    process = subprocess.Popen(
        [root() / script, name],
        stdin=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
    )
    assert process.stderr is not None
    last = ""
    for line in process.stderr:
        # One behind: the last line of a failure is told as the error.
        print(last, end="", file=sys.stderr, flush=True)
        last = line
    if process.wait() == EXIT_BAD_INPUT:
        raise UsageError(last)
    if process.returncode != 0:
        raise BenchFailure(f"{script} ended with {ending(process.returncode)}: {last}")
    print(last, end="", file=sys.stderr, flush=True)


def count(bench: Bench, image: Path, *words: int, profile: str = "off") -> dict[str, Any]:
    """Runs an image with these words to its end; what it counted and printed."""
    options = [text for word in words for text in ("--word", str(word))]
    return bench.json("count", "--image", str(image), "--profile", profile, *options)
