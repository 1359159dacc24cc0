"""Whether the program that a command names would accept its words; nothing is run but `--help`."""

import re
import subprocess
import sys
from functools import lru_cache
from pathlib import Path

PROGRAMS = {
    "./tools/quiesce": ("quiesce", ()),
    "./tools/hil": ("quiesce", ("hil",)),
    "./tools/benchmark": ("quiesce_benchmarks", ()),
}
ACTION = re.compile(r"[a-z_]+")


@lru_cache
def help_of(module: str, words: tuple[str, ...]) -> str:
    """What `--help` prints, on one line; empty where the program refuses the words."""
    command = [sys.executable, "-m", module, *words, "--help"]
    done = subprocess.run(command, capture_output=True, text=True)
    return " ".join(done.stdout.split()) if done.returncode == 0 else ""


def refused(command: str, root: Path) -> str:
    """Why a command cannot be typed, in a few words; empty where it can.

    Its words are those of a sub-command, then options with their values and files. Every option
    has to be in the sub-command's help, a value in the choices that stand there, a file of the
    project in the tree; words in capitals (FILE.csv) and files below build/ are the user's.
    """
    program, *words = command.split()
    if program not in PROGRAMS:
        return f"{program}: no program of the project"
    module, before = PROGRAMS[program]
    count = next((i for i, word in enumerate(words) if not ACTION.fullmatch(word)), len(words))
    actions = (*before, *words[:count])
    text = help_of(module, actions)
    if not re.match(rf"usage: [\w-]+ {' '.join(actions)}\b", text):
        return f"{program} {' '.join(words[:count])}: no such command"
    return bad_option(words[count:], text) or bad_file(words[count:], root)


def bad_option(words: list[str], text: str) -> str:
    for word, after in zip(words, [*words, ""][1:], strict=True):
        if not word.startswith("--"):
            continue
        found = re.search(rf"(?<![\w-]){word}(?![\w-])(?: \{{([^}}]*)\}})?", text)
        if found is None:
            return f"{word}: no such option"
        if found[1] is not None and after not in found[1].split(","):
            return f"{word} {after}: not one of {found[1]}"
    return ""


def bad_file(words: list[str], root: Path) -> str:
    files = (word for word in words if "/" in word and not word.startswith("build/"))
    return next((f"{file}: no such file" for file in files if not (root / file).exists()), "")
