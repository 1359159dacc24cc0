"""The rules of the Python modules: who imports whom, who speaks to the user, no rig by name, and
nothing that is never used."""

import os
from collections import Counter
from collections.abc import Iterator
from fnmatch import fnmatch

from house.python_sources import Module, Package, room_of_module
from house.rooms import RIGS, table

MOST_FLAT_MODULES = 3


def product(package: Package) -> Iterator[tuple[str, Module]]:
    for name, module in package.modules.items():
        if name.split(".")[0] == "quiesce":
            yield name, module


def import_violations(package: Package) -> Iterator[str]:
    rooms = table()["python"]
    for name, targets in package.imports.items():
        room = room_of_module(name)
        path = package.modules[name].path
        if name != "quiesce" and room not in rooms:
            yield f"{path} is in no room of the table"
            continue
        allowed = {room, "quiesce", *rooms.get(room, ())}
        for target in sorted(targets):
            if "*" not in allowed and room_of_module(target) not in allowed:
                yield f"{path} imports {target}"


def unreadable_imports(package: Package) -> Iterator[str]:
    """A module that only the run names is seen by no check."""
    for name, module in product(package):
        for beginning, line in module.by_name:
            if beginning is None and name not in table()["named_at_run_time"]:
                yield f"{module.path}:{line} imports what only the run names"


def speech_violations(package: Package) -> Iterator[str]:
    """argparse and print live in the commands."""
    for name, module in product(package):
        is_command = room_of_module(name) == "cli" or name.endswith(".__main__")
        if is_command or name in table()["speaks"]:
            continue
        parsers = [("argparse", one.line) for one in module.imports if one.base == "argparse"]
        for words, line in module.speech + parsers:
            yield f"{module.path}:{line} has {words}; that is a command's"


def rig_violations(package: Package) -> Iterator[str]:
    """A rig is data. Help texts of commands may show it as an example."""
    for name, module in product(package):
        if any(fnmatch(name, pattern) for pattern in table()["rig_named"]):
            continue
        for text, line in module.texts:
            for rig in RIGS:
                if rig in text:
                    yield f"{module.path}:{line} names the rig {rig}"


def flatness_violations(package: Package) -> Iterator[str]:
    found = flat_modules(package)
    if len(found) > MOST_FLAT_MODULES:
        yield f"{len(found)} modules in the package's root: {', '.join(found)}"


def flat_modules(package: Package) -> list[str]:
    """Modules that lie in the package's root."""
    paths = [module.path for _, module in product(package)]
    return [path for path in paths if os.path.dirname(path) == "tools/src/quiesce"]


def unreferenced(package: Package) -> Iterator[str]:
    """Functions, classes and constants of the package that no line of the project names. Names are
    compared, not what they stand for: what it finds is dead, not all that is dead is found."""
    elsewhere: set[str] = set().union(*(m.elsewhere for m in package.modules.values()))
    imported, kept = package.imported_names(), table()["kept"]
    for name, module in product(package):
        readers = Counter(word for one in module.statements for word in one.reads)
        for statement in module.statements:
            for word in sorted(statement.binds - elsewhere - imported.get(name, set())):
                is_read = readers[word] > (word in statement.reads)
                if not is_read and not word.startswith("__") and f"{name}.{word}" not in kept:
                    yield f"{module.path}:{statement.line} {word} is named nowhere"


CHECKS = (
    import_violations,
    unreadable_imports,
    speech_violations,
    rig_violations,
    flatness_violations,
    unreferenced,
)
