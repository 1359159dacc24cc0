"""The rules of the C and C++ sources: who includes whom, and the bounds of the firmware."""

import os
import re
from collections.abc import Iterator
from fnmatch import fnmatch

from house.c_sources import Source, Tree, room_of, sees
from house.circles import circles_of
from house.rooms import table

CALL = re.compile(r"\b(\w+)\s*\(")
FREESTANDING = {"limits.h", "stdbool.h", "stddef.h", "stdint.h"}
FORBIDDEN_WORDS = {
    "no floating point": {"float", "double"},
    "no heap": {"malloc", "calloc", "realloc", "free", "alloca"},
    "no text output": {"printf", "sprintf", "snprintf", "puts", "putchar"},
    "no jumps between functions": {"setjmp", "longjmp"},
}


def block_sees(source: Source, header: str) -> bool:
    """Of its own room, a block sees its own header and what the table lists for it."""
    shared = table()["blocks"].get(room_of(source.path))
    name = os.path.basename(header)
    if shared is None or name == f"{source.stem}.h":
        return True
    listed = [headers for stem, headers in shared.items() if fnmatch(source.stem, stem)]
    return any(name in headers for headers in listed)


def include_violations(tree: Tree) -> Iterator[str]:
    for source in tree.sources.values():
        room = room_of(source.path)
        if not room:
            yield f"{source.path} is in no room of the table"
            continue
        for name in source.computed:
            yield f"{source.path} includes {name}: what that is, only the compiler knows"
        for header in sorted({*source.quoted, *source.angled}):
            target = tree.included(source, header)
            if target is None:
                is_allowed = header in source.angled or header in table()["outside"]
            elif room_of(target) == room:
                is_allowed = block_sees(source, target)
            else:
                is_allowed = sees(room, target)
            if not is_allowed:
                yield f"{source.path} includes {header}"


def system_header_violations(tree: Tree) -> Iterator[str]:
    """The firmware's core is freestanding; its messages may copy memory."""
    for source in tree.below("firmware"):
        extra = {"string.h"} if source.path.startswith("firmware/comm/") else set()
        for header in sorted(set(source.angled) - FREESTANDING - extra):
            yield f"{source.path} includes <{header}>"


def word_violations(tree: Tree) -> Iterator[str]:
    """Words that no integer-only, heap-free source has. The generated codec of cantools comes with
    conversions to physical values that nothing calls; check_symbols.cmake looks at the images."""
    for source in tree.below("firmware"):
        if "generated" in source.path:
            continue
        for rule, forbidden in FORBIDDEN_WORDS.items():
            for word in sorted(source.words & forbidden):
                yield f"{source.path} has '{word}': {rule}"


def call_graph(tree: Tree) -> dict[str, set[str]]:
    """Calls between the functions that the firmware defines, as "file: name"."""
    bodies = {(s.path, name): body for s in tree.below("firmware") for name, body in s.bodies}
    by_name: dict[str, list[tuple[str, str]]] = {}
    for key in bodies:
        by_name.setdefault(key[1], []).append(key)
    graph = {}
    for (path, name), body in bodies.items():
        called = set(CALL.findall(body)) & by_name.keys()
        # A name of the same file wins: it may be static.
        graph[f"{path}: {name}"] = {
            f"{target}: {callee}"
            for callee in called
            for target, _ in by_name[callee]
            if target == path or (path, callee) not in bodies
        }
    return graph


def recursion_violations(tree: Tree) -> Iterator[str]:
    for circle in circles_of(call_graph(tree)):
        yield f"recursion: {', '.join(circle)}"


def rig_violations(tree: Tree) -> Iterator[str]:
    """A rig is data: its rules and pulses lie in firmware/plants/, and CMake picks them."""
    for source in tree.below("firmware", "hal", "targets"):
        if source.rigs and room_of(source.path) != "firmware/plants":
            yield f"{source.path} names the rig {source.rigs[0]}"


CHECKS = (
    include_violations,
    rig_violations,
    system_header_violations,
    word_violations,
    recursion_violations,
)
