"""The C and C++ files of a tree: what each includes, and which files lean on which."""

import os
import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import cache, cached_property, lru_cache
from pathlib import Path

from house.circles import Graph
from house.rooms import RIGS, folders, table

SUFFIXES = (".c", ".h", ".cpp", ".hpp")
INCLUDE = re.compile(r'^\s*#\s*include\s*(?:"([^"]+)"|<([^>]+)>|(\w+))', re.MULTILINE)
# Texts first: what looks like a comment in one is none.
COMMENT = re.compile(r"""("(?:\\.|[^"\\\n])*"|'(?:\\.|[^'\\\n])+')|//[^\n]*|/\*.*?\*/""", re.DOTALL)
STRING = re.compile(r'"(?:\\.|[^"\\\n])*"')
FUNCTION = re.compile(
    r"^(?!typedef|#)([^\n;={}()]*?)\b(\w+)\([^;{}]*\)(?: const| noexcept| override)*\s*\{\n"
    r"(.*?)^\}",
    re.MULTILINE | re.DOTALL,
)
WORD = re.compile(r"\b[A-Za-z_]\w*\b")
# Of GCC; it looks like a function.
ATTRIBUTE = re.compile(r"__attribute__\s*\(\((?:[^()]|\([^()]*\))*\)\)")


@dataclass(frozen=True)
class Source:
    path: str  # in the project
    text: str  # without comments and strings
    quoted: tuple[str, ...] = ()
    angled: tuple[str, ...] = ()
    computed: tuple[str, ...] = ()  # #include NAME_OF_A_MACRO
    words: frozenset[str] = field(default=frozenset(), repr=False)
    bodies: tuple[tuple[str, str], ...] = field(default=(), repr=False)  # name, body of functions
    extern: frozenset[str] = frozenset()  # functions that it defines for others
    rigs: tuple[str, ...] = ()  # that it names, in comments and strings too

    @property
    def stem(self) -> str:
        return Path(self.path).stem

    @property
    def folder(self) -> str:
        return os.path.dirname(self.path)


@lru_cache(maxsize=4096)
def parsed(path: str, raw: str) -> Source:
    text = COMMENT.sub(lambda found: found[1] or " ", raw)
    found = INCLUDE.findall(text)
    text = ATTRIBUTE.sub(" ", STRING.sub('""', text))
    functions = FUNCTION.findall(text)
    return Source(
        path=path,
        text=text,
        quoted=tuple(quoted for quoted, _, _ in found if quoted),
        angled=tuple(angled for _, angled, _ in found if angled),
        computed=tuple(name for _, _, name in found if name),
        words=frozenset(WORD.findall(text)),
        bodies=tuple((name, body) for _, name, body in functions),
        extern=frozenset(name for kind, name, _ in functions if "static" not in kind.split()),
        rigs=tuple(rig for rig in RIGS if rig in raw),
    )


@cache
def room_of(path: str) -> str:
    """The longest listed folder that holds it; "" where none does."""
    rooms = [room for room in table()["c"] if path.startswith(f"{room}/")]
    return max(rooms, key=len, default="")


def sees(room: str, header: str) -> bool:
    """Whether files of a room may include a header, by the table of rooms."""
    allowed = table()["c"].get(room, [])
    return (
        room_of(header) == room or "*" in allowed or room_of(header) in allowed or header in allowed
    )


class Tree:
    """The C and C++ files of a tree, by path."""

    def __init__(self, root: Path) -> None:
        self.sources: dict[str, Source] = {}
        for folder, _, files in folders(root):
            for name in files:
                if name.endswith(SUFFIXES):
                    path = os.path.join(folder, name)
                    raw = (root / path).read_text(encoding="utf-8")
                    self.sources[path] = parsed(path, raw)

    def with_file(self, path: str, raw: str) -> "Tree":
        """The same with one file as given."""
        other = object.__new__(Tree)
        other.sources = self.sources | {path: parsed(path, raw)}
        if path in self.sources:  # no name is new: the others include what they did
            other.by_name = self.by_name
            other.includes = self.includes | {path: other.includes_of(other.sources[path])}
        return other

    def below(self, *places: str) -> Iterator[Source]:
        for path, source in self.sources.items():
            if path.startswith(tuple(f"{place}/" for place in places)):
                yield source

    @cached_property
    def by_name(self) -> dict[str, list[str]]:
        names: dict[str, list[str]] = {}
        for path in self.sources:
            names.setdefault(os.path.basename(path), []).append(path)
        return names

    def included(self, source: Source, header: str) -> str | None:
        """The file that an include means, in quotes or not: beside the one that includes it, else
        the one that its room may see, else any. None where it is none of the project's."""
        beside = os.path.normpath(os.path.join(source.folder, header))
        if beside in self.sources:
            return beside
        ending = f"/{header.removeprefix('../')}"
        while "/../" in ending:
            ending = ending.split("/../")[-1]
        found = [p for p in self.by_name.get(os.path.basename(header), ()) if p.endswith(ending)]
        room = room_of(source.path)
        return min(found, key=lambda path: (not sees(room, path), path), default=None)

    @cached_property
    def includes(self) -> Graph:
        """File -> files that it includes."""
        return {path: self.includes_of(source) for path, source in self.sources.items()}

    def includes_of(self, source: Source) -> set[str]:
        found = {self.included(source, header) for header in source.quoted + source.angled}
        return {path for path in found if path is not None}

    @cached_property
    def leans_on(self) -> Graph:
        """File -> files that it includes, and whose functions it calls: those of its folder in C,
        and those that an included X.h declares and X.c or X.cpp defines. So no header hides a
        circle of the files behind it. A call through another folder's interface is none."""
        graph = {path: set(targets) for path, targets in self.includes.items()}
        for path, source in self.sources.items():
            if not path.endswith((".c", ".cpp")):
                continue
            for target in self.callees(source):
                graph[path].add(target)
        return graph

    def callees(self, source: Source) -> Iterator[str]:
        if source.path.endswith(".c"):
            defined = self.defined_in[source.folder]
            for name in source.words & defined.keys() - {own for own, _ in source.bodies}:
                yield from defined[name]
        seen = self.includes[source.path]
        own = f"{os.path.splitext(source.path)[0]}.h"
        for header in seen | self.includes.get(own, set()):
            for suffix in (".c", ".cpp"):
                body = self.sources.get(header.removesuffix(".h") + suffix)
                declared = self.sources[header].words & source.words
                if body and body.path != source.path and declared & body.extern:
                    yield body.path

    @cached_property
    def defined_in(self) -> dict[str, dict[str, set[str]]]:
        """Folder -> C function -> files that define it."""
        found: dict[str, dict[str, set[str]]] = {}
        for path, source in self.sources.items():
            names = found.setdefault(source.folder, {})
            if path.endswith(".c"):
                for name in source.extern - {"main"}:
                    names.setdefault(name, set()).add(path)
        return found
