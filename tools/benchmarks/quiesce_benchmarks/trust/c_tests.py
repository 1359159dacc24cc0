"""The C tests of a build: how each is compiled, linked and run, as the build system says."""

import json
import os
import re
import shlex
import subprocess
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from quiesce.base.errors import BenchFailure

# Folders of the build whose tests judge mutants.
FOLDERS = ("tests/unit/firmware", "tests/unit/comm", "tests/golden")


def output_of(command: Sequence[str | Path], folder: Path) -> str:
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True)
    if done.returncode != 0:
        last = (done.stderr or done.stdout).strip().splitlines()[-1:]
        raise BenchFailure(f"{command[0]} ended with {done.returncode}: {' '.join(last)}")
    return done.stdout


@dataclass(frozen=True)
class CTest:
    name: str
    program: str  # in the build folder
    command: list[str]  # as ctest runs it, with PROGRAM's path in it
    link: list[str]

    def command_for(self, program: Path, build: Path) -> list[str]:
        """As ctest runs it, of another program."""
        return [word.replace(str(build / self.program), str(program)) for word in self.command]

    def link_with(self, objects: dict[str, Path], program: Path) -> list[str]:
        """With these objects in the place of those of their names, in libraries as well."""
        inside = [str(new) for old, new in objects.items() if old not in self.link]
        words = [str(objects[word]) if word in objects else word for word in self.link]
        at = self.link.index("-o")
        return [*words[:at], "-o", str(program), *inside, *words[at + 2 :]]


def archive_of(made: str) -> str:
    """The library that an object belongs to: a/CMakeFiles/name.dir/b.o -> a/libname.a."""
    folder, _, rest = made.partition("CMakeFiles/")
    return f"{folder}lib{rest.split('.dir/')[0]}.a"


class Build:
    """A build folder of CMake and ninja in which the tests have been built."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder

    @cached_property
    def compile(self) -> dict[str, list[str]]:
        """Object -> the command that makes it, without a compiler cache."""
        rows = json.loads((self.folder / "compile_commands.json").read_text())
        found = {}
        for row in rows:
            words = shlex.split(row["command"])
            words = words[1:] if words[0].endswith("ccache") else words
            found[words[words.index("-o") + 1]] = words
        return found

    @cached_property
    def depends(self) -> dict[str, set[str]]:
        """Object -> files that it was made of, absolute."""
        found: dict[str, set[str]] = {}
        current: set[str] = set()
        for line in output_of(["ninja", "-t", "deps"], self.folder).splitlines():
            if line.startswith("    "):
                current.add(os.path.normpath(self.folder / line.strip()))
            elif ": #deps" in line:
                current = found.setdefault(line.split(": #deps")[0], set())
        return found

    @cached_property
    def tests(self) -> list[CTest]:
        shown = output_of(["ctest", "--show-only=json-v1"], self.folder)
        found = []
        for test in json.loads(shown)["tests"]:
            program = self.program_in(test.get("command", []))
            # same_bits also wants an image, and compares builds of one source: of no use here.
            if program is not None and test["name"] != "same_bits":
                link = self.link_of(program)
                found.append(CTest(test["name"], program, test["command"], link))
        return found

    def program_in(self, command: list[str]) -> str | None:
        for word in command:
            for folder in FOLDERS:
                at = re.search(re.escape(f"{self.folder}/{folder}/") + r"\w+", word)
                if at is not None and Path(at.group()).is_file():
                    return str(Path(at.group()).relative_to(self.folder))
        return None

    def link_of(self, program: str) -> list[str]:
        commands = output_of(["ninja", "-t", "commands", program], self.folder)
        words = shlex.split(commands.splitlines()[-1])
        return [word for word in words if word not in (":", "&&")]

    def objects_of(self, test: CTest, file: Path) -> list[str]:
        """Objects that are made of a file and that the test links."""
        made = [one for one, files in self.depends.items() if str(file) in files]
        return [one for one in made if one in test.link or self.is_drawn_in(test, one)]

    def first_object_of(self, file: Path) -> str:
        """Of the objects of libraries that are made of a file. BenchFailure where none is."""
        linked = {word for test in self.tests for word in test.link}
        made = [one for one, files in self.depends.items() if str(file) in files]
        found = [one for one in made if archive_of(one) in linked]
        if not found:
            raise BenchFailure(f"no test has {file.name} in it")
        return min(found)

    def is_drawn_in(self, test: CTest, made: str) -> bool:
        """Whether a test has an object of a library in it, and none that takes its place."""
        if archive_of(made) not in test.link:
            return False
        names = self.symbols(made)
        own = [word for word in test.link if word.endswith(".o")]
        if any(names & self.symbols(one) for one in own):
            return False
        return bool(names & self.symbols(test.program))

    def symbols(self, made: str) -> frozenset[str]:
        """Names that it defines for others."""
        if made not in self._symbols:
            lines = output_of(["nm", "--defined-only", "-g", made], self.folder).splitlines()
            self._symbols[made] = frozenset(line.split()[-1] for line in lines if line)
        return self._symbols[made]

    @cached_property
    def _symbols(self) -> dict[str, frozenset[str]]:
        return {}
