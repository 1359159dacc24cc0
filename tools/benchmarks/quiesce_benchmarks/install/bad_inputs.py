"""Bad inputs of every command, made of its good example: a program of its own, for the Python of an
installed package.

    bad_inputs.py FOLDER < EXAMPLES.json

FOLDER holds what the examples have made. Of each example every file that it reads is missing, a
folder, empty, of random bytes, cut in half or full of NaN, each number is none or far out of range,
and an option is unknown. Prints one JSON object: by what was typed "ok" or what was wrong.
"""

import contextlib
import hashlib
import io
import json
import random
import re
import shlex
import sys
from collections.abc import Callable, Iterator
from importlib.metadata import entry_points
from pathlib import Path

EXIT_BAD_INPUT = 2
PRINTS_WHAT_COMES_BEFORE = ["can", "decode"]  # where a log is malformed, as its help says
# What a line that tells what to do has one of.
REMEDIES = re.compile(
    r"; |see '|expected|there are|choose from|name |say |give |must|required|needs?|at least|"
    r"at most|allowed|\.\.|is not|are not|No such|a folder|did you mean|empty"
)


def damaged(good: Path, folder: Path) -> Iterator[Path]:
    """Files like this one, but for what is wrong with each; names tell what."""
    data = good.read_bytes()
    for name, content in {
        "empty": b"",
        "random": random.Random(1).randbytes(400),
        "half": data[: len(data) // 2] + b"\x00",
        "nan": re.sub(rb"\d+\.?\d*", b"nan", data),
    }.items():
        file = folder / f"{name}{good.suffix}"
        file.write_bytes(content)
        yield file
    yield folder / f"missing{good.suffix}"
    (folder / "folder").mkdir(exist_ok=True)
    yield folder / "folder"


def variants(words: list[str], outputs: set[int], folder: Path) -> Iterator[list[str]]:
    """The example with one thing wrong. outputs: words that it writes to."""
    yield [*words, "--no-such-option"]
    for i, word in enumerate(words):
        before, after = words[:i], words[i + 1 :]
        if i in outputs:
            continue
        if Path(word).is_file():
            for file in damaged(Path(word), folder):
                yield [*before, str(file), *after]
        elif re.fullmatch(r"-?\d+\.?\d*", word):
            yield [*before, "none", *after]
            yield [*before, "nan", *after]
            yield [*before, "-1e30", *after]
        elif word.startswith("--") and i + 1 < len(words):
            yield [*before, word, "", *after[1:]]


def outputs_of(words: list[str]) -> set[int]:
    return {i for i, word in enumerate(words) if i and words[i - 1] in ("--out", "-o", "--write")}


def state_of(folder: Path) -> str:
    found = hashlib.sha256()
    for file in sorted(folder.rglob("*")):
        found.update(str(file).encode())
        if file.is_file():
            found.update(file.read_bytes())
    return found.hexdigest()


def verdict(main: Callable[[list[str]], int], words: list[str], folder: Path) -> str:
    before = state_of(folder)
    out, err = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        code = main(words)
    lines = err.getvalue().splitlines()
    if code != EXIT_BAD_INPUT:
        return f"exit code {code}: {' / '.join(lines[-2:])}"
    if len(lines) != 1 and words[:2] != PRINTS_WHAT_COMES_BEFORE:
        return f"{len(lines)} lines: {' / '.join(lines[-3:])}"
    if "internal error" in lines[-1] or not REMEDIES.search(lines[-1]):
        return f"does not say what to do: {lines[-1]}"
    if out.getvalue() and words[:2] != PRINTS_WHAT_COMES_BEFORE:
        return "something on standard output"
    return "ok" if state_of(folder) == before else "something was written"


def run(folder: Path, examples: list[list[str]]) -> dict[str, str]:
    (script,) = entry_points(group="console_scripts", name="quiesce")
    main = script.load()
    bad = folder / "bad"
    bad.mkdir(exist_ok=True)
    found = {}
    for name, tail in examples:
        words = shlex.split(f"{name} {tail}")
        for one in variants(words, outputs_of(words), bad):
            found[shlex.join(one)] = verdict(main, one, folder)
    return found


if __name__ == "__main__":
    import os

    os.chdir(sys.argv[1])
    print(json.dumps(run(Path("."), json.load(sys.stdin)), indent=1))
