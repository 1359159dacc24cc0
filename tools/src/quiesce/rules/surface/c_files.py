"""A surface as C: its table, and a header."""

from quiesce.rules.integers.c_files import table_text
from quiesce.rules.surface.compile import Surface
from quiesce.rules.system.c_files import header_text


def header_c(surface: Surface, name: str, banner: str) -> str:
    title = f"Surface of fuzzy system {surface.scaled.system.name} in integers (fuzzy.h)"
    declaration = (
        "/// For fuzzy_evaluate(): the words of a fuzzy_table_t.\n"
        f"extern const uint32_t {name}_table[{len(surface.words)}];\n"
    )
    return header_text(surface.scaled, name, f"{banner}/// {title}:\n", '"fuzzy.h"', declaration)


def source_c(surface: Surface, name: str, banner: str) -> str:
    return f'{banner}#include "{name}.h"\n\n{table_text(surface.words, name)}'
