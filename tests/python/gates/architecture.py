"""Checks the dependency rules and the bounds of the C and C++ sources, by reading them.

base <- blocks <- controller <- app -> hal interface <- backends. A block sees base, its own header
and the public types; only firmware/chain sees several blocks; sim_hil sees the public headers only;
linux what a target runs (app, messages) and the backends for Linux.
"""

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

INCLUDE = re.compile(r'^\s*#\s*include\s*(?:"([^"]+)"|<([^>]+)>)', re.MULTILINE)
COMMENT = re.compile(r"//[^\n]*|/\*.*?\*/", re.DOTALL)
STRING = re.compile(r'"(?:\\.|[^"\\\n])*"')
FUNCTION = re.compile(r"^(?!typedef|#)[^\n;={}()]*?\b(\w+)\([^;{}]*\)\s*\{\n(.*?)^\}", re.M | re.S)
CALL = re.compile(r"\b(\w+)\s*\(")

PUBLIC = {"quiesce.h", "quiesce_params.h", "quiesce_version.h"}
FREESTANDING = {"limits.h", "stdbool.h", "stddef.h", "stdint.h"}
BLOCK_FOLDERS = ("sense", "fuzzy", "guard", "law")
# Headers of its own folder that a block may see beside its own: constant data of the block, or the
# interface that the folder's files implement.
SHARED = {
    "spectrum": {"cosine_table.h"},
    # Down to the arithmetic that straight-line rule bases share with the table engine.
    "fuzzy": {"fuzzy_forms.h", "fuzzy_table.h", "fuzzy_math.h"},
    "fuzzy_forms": {"fuzzy.h"},
    "fuzzy_centroid": {"fuzzy_forms.h"},
    "fuzzy_partition": {"fuzzy_forms.h"},
    "fuzzy_table": {"fuzzy_math.h"},
    "rules_*": {"fuzzy_math.h"},
    # The state of any law holds that of the phase law.
    "law": {"law_phase.h"},
    "law_phase": {"law.h", "adapt.h", "phase_table.h"},
    "law_*": {"law.h"},
    "adapt": {"adapt_effect.h"},
    "adapt_store": {"adapt.h"},
}
# What the simulation may know of the firmware and the simulated peripherals.
SIM_SEES = PUBLIC | {
    "lockstep.h",
    "mailbox.h",
    "can_frame.h",
    "slcan.h",
    "lockstep_can.h",
    "quiesce_can.h",
}
FORBIDDEN_WORDS = {
    "no floating point": {"float", "double"},
    "no heap": {"malloc", "calloc", "realloc", "free", "alloca"},
    "no text output": {"printf", "sprintf", "snprintf", "puts", "putchar"},
    "no jumps between functions": {"setjmp", "longjmp"},
}


@dataclass
class Source:
    path: str  # in the project
    text: str  # without comments and strings
    quoted: list[str] = field(default_factory=list)
    angled: list[str] = field(default_factory=list)

    @property
    def stem(self) -> str:
        return Path(self.path).stem

    @property
    def folder(self) -> str:
        return str(Path(self.path).parent)


def read_sources(root: Path, *folders: str) -> list[Source]:
    sources = []
    for folder in folders:
        for file in sorted((root / folder).rglob("*")):
            if file.suffix in (".c", ".h", ".cpp", ".hpp"):
                sources.append(read_source(root, file))
    return sources


def read_source(root: Path, file: Path) -> Source:
    text = COMMENT.sub(" ", file.read_text(encoding="utf-8"))
    found = INCLUDE.findall(text)
    return Source(
        path=str(file.relative_to(root)),
        text=STRING.sub('""', text),
        quoted=[quoted for quoted, _ in found if quoted],
        angled=[angled for _, angled in found if angled],
    )


def headers_in(root: Path, folder: str) -> set[str]:
    return {file.name for file in (root / folder).glob("*.h")}


def shared_headers(stem: str) -> set[str]:
    """By the file's name; a key that ends in * is how the name begins."""
    for key, headers in SHARED.items():
        if stem == key or (key.endswith("*") and stem.startswith(key[:-1])):
            return headers
    return set()


def allowed_headers(root: Path, source: Source) -> set[str]:
    """Project headers that a file of the firmware or the HAL may include."""
    own = {f"{source.stem}.h"}
    base = headers_in(root, "firmware/base")
    folders = (*BLOCK_FOLDERS, "fuzzy/generated", "law/generated")
    blocks = {h for name in folders for h in headers_in(root, f"firmware/{name}")}
    interface = {f"hal/{name}" for name in headers_in(root, "hal/include/hal")}
    comm = headers_in(root, "firmware/comm") | headers_in(root, "firmware/comm/generated")
    parts = Path(source.path).parts
    if parts[0] == "hal":
        if parts[1] == "include":
            return interface
        backend = headers_in(root, source.folder) | headers_in(root, "hal/sim")
        return interface | backend | comm | PUBLIC | {"app.h", "node.h"}
    layer = parts[1]
    if layer == "base":
        return base
    if layer in BLOCK_FOLDERS:
        return own | base | PUBLIC | shared_headers(source.stem)
    if layer == "src":
        return headers_in(root, "firmware/chain") | base | blocks | PUBLIC
    if layer == "app":
        return headers_in(root, "firmware/app") | comm | PUBLIC | interface
    if layer == "param":
        return headers_in(root, "firmware/param") | PUBLIC
    if layer == "include":
        return PUBLIC
    if layer == "comm":
        return comm | base | PUBLIC
    return set()


def include_violations(root: Path) -> Iterator[str]:
    for source in read_sources(root, "firmware", "hal"):
        for header in sorted(set(source.quoted) - allowed_headers(root, source)):
            yield f"{source.path} includes {header}"


def simulation_violations(root: Path) -> Iterator[str]:
    """Of firmware and HAL, sim_hil includes the public headers only, by name."""
    inner = {s.path.rsplit("/", 1)[1] for s in read_sources(root, "firmware", "hal")}
    own = {s.path.rsplit("/", 1)[1] for s in read_sources(root, "sim_hil")}
    for source in read_sources(root, "sim_hil"):
        for header in source.quoted:
            name = header.rsplit("/", 1)[-1]
            is_path_inside = header.startswith(("hal/", "firmware/")) or ".." in header
            is_inner = name in inner and name not in own and name not in SIM_SEES
            if is_path_inside or is_inner:
                yield f"{source.path} includes {header}"


def linux_violations(root: Path) -> Iterator[str]:
    """The Linux program sees what a target runs, the lock-step server and its own backends."""
    seen = PUBLIC | SIM_SEES
    for folder in ("app", "comm", "comm/generated"):
        seen |= headers_in(root, f"firmware/{folder}")
    for folder in ("linux", "include/hal"):
        seen |= headers_in(root, f"hal/{folder}")
    inner = {s.path.rsplit("/", 1)[1] for s in read_sources(root, "firmware", "hal")}
    for source in read_sources(root, "linux"):
        for header in source.quoted:
            name = header.rsplit("/", 1)[-1]
            is_path_inside = header.startswith(("firmware/", "hal/linux/")) or ".." in header
            if is_path_inside or (name in inner and name not in seen):
                yield f"{source.path} includes {header}"


def system_header_violations(root: Path) -> Iterator[str]:
    """The firmware's core is freestanding; its messages may copy memory."""
    for source in read_sources(root, "firmware"):
        extra = {"string.h"} if source.path.startswith("firmware/comm/") else set()
        for header in sorted(set(source.angled) - FREESTANDING - extra):
            yield f"{source.path} includes <{header}>"


def word_violations(root: Path) -> Iterator[str]:
    """Words that no integer-only, heap-free source has. The generated codec of cantools comes with
    conversions to physical values that nothing calls; check_symbols.cmake looks at the images."""
    for source in read_sources(root, "firmware"):
        if "generated" in source.path:
            continue
        words = set(re.findall(r"\b[A-Za-z_]\w*\b", source.text))
        for rule, forbidden in FORBIDDEN_WORDS.items():
            for word in sorted(words & forbidden):
                yield f"{source.path} has '{word}': {rule}"


def call_graph(root: Path) -> dict[tuple[str, str], set[tuple[str, str]]]:
    """Calls between the functions that the firmware defines, by (file, name)."""
    sources = read_sources(root, "firmware")
    bodies = {
        (source.path, name): body
        for source in sources
        for name, body in FUNCTION.findall(source.text)
    }
    by_name: dict[str, list[tuple[str, str]]] = {}
    for key in bodies:
        by_name.setdefault(key[1], []).append(key)
    graph = {}
    for key, body in bodies.items():
        called = set(CALL.findall(body)) & by_name.keys()
        # A name of the same file wins: it may be static.
        graph[key] = {
            target
            for name in called
            for target in by_name[name]
            if target[0] == key[0] or (key[0], name) not in bodies
        }
    return graph


def recursion_violations(root: Path) -> Iterator[str]:
    graph = call_graph(root)
    done: set[tuple[str, str]] = set()

    def visit(node: tuple[str, str], path: list[tuple[str, str]]) -> Iterator[str]:
        if node in path:
            cycle = [name for _, name in path[path.index(node) :]] + [node[1]]
            yield f"{node[0]} recurses: {' -> '.join(cycle)}"
        elif node not in done:
            for target in sorted(graph[node]):
                yield from visit(target, [*path, node])
            done.add(node)

    for node in sorted(graph):
        yield from visit(node, [])


CHECKS = (
    include_violations,
    simulation_violations,
    linux_violations,
    system_header_violations,
    word_violations,
    recursion_violations,
)


def violations(root: Path) -> list[str]:
    return [line for check in CHECKS for line in check(root)]
