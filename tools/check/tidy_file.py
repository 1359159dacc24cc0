"""Runs clang-tidy on a file of a compile_commands.json, unless it found nothing in the same text
before: after the preprocessor, with comments and macros, by the same command and settings.

    tidy_file.py BUILD FILE

What was found clean is a name in build/tidied; take that folder away, and all is looked at again.
"""

import hashlib
import json
import shlex
import subprocess
import sys
from pathlib import Path

TIDY = "clang-tidy-14"
CLEAN = Path("build/tidied")
PREPROCESSED = ("-E", "-CC", "-dD")  # with comments, NOLINT among them, and macros
WITH_VALUE = ("-o", "-MT", "-MF", "-MQ")
WITHOUT_VALUE = ("-c", "-MD", "-MMD")


def compile_words(build: str, file: str) -> tuple[list[str], str]:
    """The command that compiles the file, and the folder that it runs in."""
    wanted = str(Path(file).resolve())
    for entry in json.loads(Path(build, "compile_commands.json").read_text()):
        if entry["file"] == wanted:
            return entry.get("arguments") or shlex.split(entry["command"]), entry["directory"]
    raise SystemExit(f"{build}: no command compiles {file}")


def preprocessor_words(words: list[str]) -> list[str]:
    """The same compiler, without a cache before it and without files that it writes."""
    words = words[1:] if Path(words[0]).name == "ccache" else words
    kept: list[str] = []
    rest = iter(words)
    for word in rest:
        if word in WITH_VALUE:
            next(rest)
        elif word not in WITHOUT_VALUE:
            kept.append(word)
    return [kept[0], *PREPROCESSED, *kept[1:]]


def fingerprint(build: str, file: str) -> str | None:
    """None where the file cannot be preprocessed: clang-tidy says why."""
    words, folder = compile_words(build, file)
    done = subprocess.run(preprocessor_words(words), cwd=folder, capture_output=True)
    if done.returncode != 0:
        return None
    version = subprocess.run([TIDY, "--version"], capture_output=True, check=True).stdout
    seen = hashlib.sha256(shlex.join(words).encode())
    for part in (version, Path(".clang-tidy").read_bytes(), done.stdout):
        seen.update(b"\0" + part)
    return seen.hexdigest()


def main(build: str, file: str) -> int:
    mark = fingerprint(build, file)
    if mark is not None and (CLEAN / mark).exists():
        return 0
    code = subprocess.run([TIDY, "--quiet", "-p", build, file]).returncode
    if code == 0 and mark is not None:
        CLEAN.mkdir(parents=True, exist_ok=True)
        (CLEAN / mark).touch()
    return code


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
