"""The Python modules of a tree, and what each imports: inside functions and by name, too."""

import ast
import os
from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import cache, cached_property, lru_cache
from pathlib import Path

from house.circles import Graph
from house.rooms import RIGS, folders

# Where packages begin that have no other name than their folder's. Other modules are told by their
# path, as pytest finds them: beside the one that imports, or by a name that is there once.
PACKAGES = {
    "quiesce": "tools/src",
    "quiesce_benchmarks": "tools/benchmarks",
    "quiesce_vm": "tests/system/vm",
    "house": "tests/python/gates",
}
# Rooms beside those of the package, by where their modules are; the first that holds one wins.
ROOMS = {
    "quiesce_benchmarks": "benchmarks",
    "quiesce_vm": "vm",
    "house": "house",
    "tools/benchmarks": "benchmarks",
    "tools/gen": "gen",
    "tools/check": "check",
    "tools/lib": "lib",
    "tests": "tests",
    "examples": "examples",
}


@dataclass
class Statement:
    """One of a module's top level: the names that it binds, and those that it reads."""

    line: int
    binds: set[str] = field(default_factory=set)
    reads: set[str] = field(default_factory=set)


@dataclass(frozen=True)
class Import:
    """`import NAME` has no names; `from BASE import NAMES`, with as many dots as level."""

    base: str
    names: tuple[str, ...]
    level: int
    line: int


@dataclass
class Module:
    """What the rules ask of a module, as plain facts; one walk over its tree finds them."""

    path: str  # in the project
    imports: list[Import] = field(default_factory=list)
    texts: list[tuple[str, int]] = field(default_factory=list)  # strings that may name something
    # import_module(...): how the name begins, None where only the run knows.
    by_name: list[tuple[str | None, int]] = field(default_factory=list)
    speech: list[tuple[str, int]] = field(default_factory=list)  # print, sys.stdout
    statements: list[Statement] = field(default_factory=list)
    # Names of other modules' definitions that it may mean: as x.NAME, or as a text.
    elsewhere: set[str] = field(default_factory=set)


@lru_cache(maxsize=4096)
def parsed(path: str, raw: str) -> Module:
    module = Module(path)
    for part in ast.parse(raw, path).body:
        statement = Statement(part.lineno)
        module.statements.append(statement)
        if isinstance(part, ast.FunctionDef | ast.ClassDef | ast.AsyncFunctionDef):
            statement.binds.add(part.name)
        elif isinstance(part, ast.Assign | ast.AnnAssign):
            targets = part.targets if isinstance(part, ast.Assign) else [part.target]
            statement.binds |= {
                node.id for t in targets for node in ast.walk(t) if isinstance(node, ast.Name)
            }
        for node in ast.walk(part):
            note(node, module, statement)
    return module


def note(node: ast.AST, module: Module, statement: Statement) -> None:
    kind = type(node)
    if kind is ast.Name:
        if type(node.ctx) is not ast.Store:
            statement.reads.add(node.id)
    elif kind is ast.Attribute:
        module.elsewhere.add(node.attr)
        if node.attr == "stdout" and getattr(node.value, "id", "") == "sys":
            module.speech.append(("sys.stdout", node.lineno))
    elif kind is ast.Constant:
        if type(node.value) is str:
            note_text(node.value, node.lineno, module)
    elif kind is ast.Call:
        note_call(node, module)
    elif kind is ast.Import:
        module.imports += [Import(alias.name, (), 0, node.lineno) for alias in node.names]
    elif kind is ast.ImportFrom:
        names = tuple(alias.name for alias in node.names)
        if node.module == "sys" and "stdout" in names:
            module.speech.append(("sys.stdout", node.lineno))
        module.imports.append(Import(node.module or "", names, node.level, node.lineno))


def note_text(text: str, line: int, module: Module) -> None:
    if text.isidentifier():
        module.elsewhere.add(text)
    elif text.replace(".", "_").isidentifier() or any(rig in text for rig in RIGS):
        module.texts.append((text, line))


def note_call(call: ast.Call, module: Module) -> None:
    function = call.func
    name = function.attr if isinstance(function, ast.Attribute) else getattr(function, "id", "")
    if name == "print" and isinstance(function, ast.Name):
        module.speech.append(("print", call.lineno))
    elif name in ("import_module", "__import__"):
        module.by_name.append((beginning(call.args[0] if call.args else None), call.lineno))
    elif name in ("run_module", "run_path"):
        module.by_name.append((None, call.lineno))


def beginning(text: ast.expr | None) -> str | None:
    """How a string or f-string begins; None where only the run knows: no more than the package that
    it is in, or relative to something."""
    is_open = isinstance(text, ast.JoinedStr)
    if isinstance(text, ast.JoinedStr):
        text = text.values[0]
    if not isinstance(text, ast.Constant):
        return None
    found = str(text.value)
    is_package = is_open and found.rstrip(".") in PACKAGES
    return None if is_package or found.startswith(".") else found


def name_of(path: str) -> str:
    """quiesce.base.paths; a module in no package is told by its path without the suffix."""
    stem = path.removesuffix(".py")
    for package, folder in PACKAGES.items():
        if stem.startswith(f"{folder}/{package}/"):
            return stem.removeprefix(f"{folder}/").removesuffix("/__init__").replace("/", ".")
    return stem.removesuffix("/__init__")


@cache
def room_of_module(name: str) -> str:
    if name == "quiesce" or name.startswith("quiesce."):
        parts = name.split(".")
        return parts[1] if len(parts) > 1 and parts[1] != "__main__" else name
    for place, room in ROOMS.items():
        if name == place or name.startswith((f"{place}.", f"{place}/")):
            return room
    return ""


class Package:
    """The Python modules of a tree, by name."""

    def __init__(self, root: Path) -> None:
        self.modules: dict[str, Module] = {}
        for folder, _, files in folders(root):
            for name in files:
                if name.endswith(".py"):
                    path = os.path.join(folder, name)
                    raw = (root / path).read_text(encoding="utf-8")
                    self.modules[name_of(path)] = parsed(path, raw)

    def with_file(self, path: str, raw: str) -> "Package":
        """The same with one file as given."""
        other, name = object.__new__(Package), name_of(path)
        other.modules = self.modules | {name: parsed(path, raw)}
        if name in self.modules:  # no name is new: the others import what they did
            other.imports = self.imports | {name: other.imports_of(name)}
        return other

    def imported_names(self) -> dict[str, set[str]]:
        """Module -> names that others import from it."""
        found: dict[str, set[str]] = {}
        for name, module in self.modules.items():
            for one in module.imports:
                source = self.found(name, base_of(one, name, module))
                found.setdefault(source or "", set()).update(one.names)
        return found

    @cached_property
    def by_stem(self) -> dict[str, list[str]]:
        stems: dict[str, list[str]] = {}
        for name in self.modules:
            if "/" in name:
                stems.setdefault(name.rsplit("/", 1)[1], []).append(name)
        return stems

    def found(self, importer: str, name: str) -> str | None:
        """The project's module of that name, or None where it is none of ours."""
        if name in self.modules:
            return name
        first, *rest = name.split(".")
        if first in PACKAGES:
            return self.found(importer, name.rpartition(".")[0]) if rest else None
        beside = f"{os.path.dirname(self.modules[importer].path)}/{first}"
        if beside in self.modules:
            return beside
        there = self.by_stem.get(first, [])
        return there[0] if len(there) == 1 else None

    def imported(self, name: str) -> Iterator[str]:
        """Dotted names that a module imports, wherever it does."""
        module = self.modules[name]
        for one in module.imports:
            base = base_of(one, name, module)
            if not one.names:
                yield base
            for inside in one.names:
                yield f"{base}.{inside}" if f"{base}.{inside}" in self.modules else base
        # A table of modules, or import_module("quiesce.x"): the name says it all.
        yield from (text for text, _ in module.texts if "." in text and text in self.modules)
        # import_module(f"quiesce.cli.{name}"): any of the package.
        yield from (text.rpartition(".")[0] for text, _ in module.by_name if text)

    @cached_property
    def imports(self) -> Graph:
        """Module -> modules of the project."""
        return {name: self.imports_of(name) for name in self.modules}

    def imports_of(self, name: str) -> set[str]:
        return {m for one in self.imported(name) if (m := self.found(name, one))} - {name}


def base_of(one: Import, name: str, module: Module) -> str:
    if not one.level:
        return one.base
    is_package = module.path.endswith("__init__.py")
    parts = name.split(".")
    kept = parts[: len(parts) - one.level + is_package]
    return ".".join([*kept, one.base] if one.base else kept)
