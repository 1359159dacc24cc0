"""Who calls whom in an image, of its disassembly: what a function can reach."""

import re
import subprocess
import tempfile
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from quiesce.base.errors import BenchFailure

PREFIX = "arm-none-eabi-"
FUNCTION = re.compile(r"^(?P<address>[0-9a-f]+) <(?P<name>[^>]+)>:$")
# The place that an instruction goes to: another function, or one inside.
TARGET = re.compile(r"\s(?:b|bl|blx|cbz|cbnz)[a-z.]*\s.*<(?P<name>[^>+]+)(?:\+0x[0-9a-f]+)?>")
# Through a register; `bx lr` returns.
INDIRECT = re.compile(r"\s(?:blx|bx)\s+r\d+|\sldr[a-z.]*\s+pc, \[r")


@dataclass(frozen=True)
class CallGraph:
    calls: dict[str, frozenset[str]]  # of a function by its name
    indirect: frozenset[str]  # functions that call through a pointer
    taken: frozenset[str]  # those whose address is a word of the image

    def reachable(self, entry: str) -> frozenset[str]:
        """From the entry; a call through a pointer may be of any whose address is taken."""
        if entry not in self.calls:
            raise BenchFailure(f"the image has no function {entry}")
        seen: set[str] = set()
        waiting = [entry]
        while waiting:
            name = waiting.pop()
            if name in seen:
                continue
            seen.add(name)
            waiting += self.calls.get(name, frozenset())
            waiting += self.taken if name in self.indirect else ()
        return frozenset(seen)

    def callers(self, name: str, among: Iterable[str]) -> list[str]:
        return sorted(one for one in among if name in self.calls.get(one, ()))


def tool(name: str, *words: str | Path) -> str:
    done = subprocess.run([PREFIX + name, *map(str, words)], capture_output=True, text=True)
    if done.returncode != 0:
        raise BenchFailure(f"{PREFIX}{name}: {(done.stderr.strip() or 'failed').splitlines()[-1]}")
    return done.stdout


def read_graph(text: str, words: Iterable[int]) -> CallGraph:
    """Of what objdump -d prints and the image's words."""
    addresses: dict[int, str] = {}
    calls: dict[str, set[str]] = {}
    indirect: set[str] = set()
    name = ""
    for line in text.splitlines():
        if head := FUNCTION.match(line):
            name = head["name"]
            addresses[int(head["address"], 16)] = name
            calls.setdefault(name, set())
        elif found := TARGET.search(line):
            calls[name].add(found["name"])
        elif INDIRECT.search(line):
            indirect.add(name)
    # A pointer to Thumb code has its lowest bit set.
    taken = {addresses[word - 1] for word in words if word - 1 in addresses}
    return CallGraph(
        {one: frozenset(others - {one}) for one, others in calls.items()},
        frozenset(indirect),
        frozenset(taken),
    )


def call_graph(image: Path) -> CallGraph:
    """Of an ELF file. BenchFailure where the tools refuse it."""
    with tempfile.TemporaryDirectory() as folder:
        flat = Path(folder) / "image.bin"
        tool("objcopy", "-O", "binary", "--only-section=.text", "--only-section=.data", image, flat)
        content = flat.read_bytes()
    words = [int.from_bytes(content[i : i + 4], "little") for i in range(0, len(content), 4)]
    return read_graph(tool("objdump", "-d", "--no-show-raw-insn", image), words)
