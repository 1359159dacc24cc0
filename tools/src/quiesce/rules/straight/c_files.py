"""A system as straight-line C: its function, and a header."""

from quiesce.rules.straight.compile import StraightSystem
from quiesce.rules.straight.emit import Straight
from quiesce.rules.system.c_files import header_text


def header_c(compiled: StraightSystem, name: str, banner: str) -> str:
    heading = f"{banner}/// Fuzzy system {compiled.system.name} in integers:\n"
    return header_text(
        compiled, name, heading, "<stdint.h>",
        "/// Returns a bit for each output that no rule reached: it has its default.\n"
        f"uint32_t {name}(const int32_t *input, int32_t *output);\n",
    )  # fmt: skip


def source_c(made: Straight, name: str, banner: str) -> str:
    return f'{banner}#include "{name}.h"\n\n#include "fuzzy_polynomial.h"\n\n{made.text(name)}'
