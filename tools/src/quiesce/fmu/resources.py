"""The folder of resources of an FMU: the bench's arguments, and every file that they lead to."""

import hashlib
import os
import shutil
import tomllib
from collections.abc import Iterator, Sequence
from pathlib import Path

import tomli_w

from quiesce.base.errors import UsageError
from quiesce.base.named_files import files_in, whole
from quiesce.base.paths import shown

FILE = "fmu.toml"
FILES = "files"


def write_resources(folder: Path, kind: str, words: Sequence[str], files: dict[str, Path]) -> str:
    """Writes them and returns the token that names the model: the same for the same contents.

    words: arguments that are no files. files: options with their files. UsageError where one
    cannot be read.
    """
    places = copied(list(files.values()), folder)
    arguments = list(words)
    for option, file in files.items():
        arguments += [option, places[file.resolve()]]
    token = "{" + token_of(folder, kind, arguments) + "}"
    data = {
        "schema": "quiesce-fmu", "version": 1, "token": token, "kind": kind, "arguments": arguments,
    }  # fmt: skip
    (folder / FILE).write_text(tomli_w.dumps(data), encoding="utf-8")
    return token


def copied(files: Sequence[Path], folder: Path) -> dict[Path, str]:
    """Copies files, and those that they name, so that they find each other as before. Returns
    where each is, from the folder on."""
    every: dict[Path, None] = {}
    for file in files:
        for one in reached(file.resolve(), every):
            every[one] = None
    if not every:
        return {}
    common = Path(os.path.commonpath([file.parent for file in every]))
    places = {file: f"{FILES}/{file.relative_to(common)}" for file in every}
    for file, place in places.items():
        (folder / place).parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(file, folder / place)
    return places


def reached(file: Path, known: dict[Path, None]) -> Iterator[Path]:
    """A file, and what a TOML file names, and so on."""
    if file in known:
        return
    try:
        raw = file.read_bytes()
    except OSError as error:
        raise UsageError(f"{shown(file)}: {error.strerror}") from None
    yield file
    if file.suffix != ".toml":
        return
    try:
        data = tomllib.loads(raw.decode())
    except (tomllib.TOMLDecodeError, UnicodeDecodeError):
        return  # the library says what is wrong
    for named in files_in(whole(data, file.parent)):
        yield from reached(named, {**known, file: None})


def token_of(folder: Path, kind: str, arguments: Sequence[str]) -> str:
    """In the form of a GUID."""
    digest = hashlib.sha256("\0".join([kind, *arguments]).encode())
    for file in sorted(one for one in folder.rglob("*") if one.is_file()):
        digest.update(str(file.relative_to(folder)).encode() + b"\0" + file.read_bytes())
    text = digest.hexdigest()
    return "-".join((text[:8], text[8:12], text[12:16], text[16:20], text[20:32]))
