"""A compiled base as C: its table, its straight-line function, a header for both."""

from collections.abc import Sequence

from quiesce.rules.integers.compiled import CompiledBase
from quiesce.rules.integers.emit import straight_line_c, why_not_straight
from quiesce.rules.integers.table import table_words

WORDS_A_LINE = 6


def table_text(values: Sequence[int], name: str) -> str:
    """`const uint32_t NAME_table[]`."""
    words = [f"0x{word:08X}u," for word in values]
    lines = [
        "    " + " ".join(words[start : start + WORDS_A_LINE])
        for start in range(0, len(words), WORDS_A_LINE)
    ]
    return f"const uint32_t {name}_table[{len(words)}] = {{\n" + "\n".join(lines) + "\n};\n"


def call_text(name: str) -> str:
    """Of the engine with the table."""
    return f"fuzzy_evaluate((const fuzzy_table_t *)(const void *){name}_table, input, output)"


def units_text(compiled: CompiledBase) -> list[str]:
    """What the integers stand for, a line a variable."""
    lines = []
    for variable, axis in zip(compiled.base.inputs, compiled.axes, strict=True):
        lines.append(
            f"input  {variable.name}: {float(axis.lsb):.9g} a count from {float(axis.origin):g}; "
            f"universe {variable.minimum:g} .. {variable.maximum:g}"
        )
    for variable, output in zip(compiled.base.outputs, compiled.outputs, strict=True):
        lines.append(
            f"output {variable.name}: {float(output.axis.lsb):.9g} a count from "
            f"{float(output.axis.origin):g}; default {output.default}"
        )
    return lines


def header_c(compiled: CompiledBase, name: str, banner: str) -> str:
    guard = f"{name.upper()}_H"
    units = "".join(f"///   {line}\n" for line in units_text(compiled))
    straight = ""
    if not why_not_straight(compiled):
        straight = (
            "\n/// The same as straight-line C: a fuzzy_function_t.\n"
            f"uint32_t {name}(const int32_t *input, int32_t *output);\n"
        )
    return (
        f"{banner}/// Rule base {compiled.base.name} in integers (fuzzy.h):\n{units}"
        f"#ifndef {guard}\n#define {guard}\n\n#include <stdint.h>\n\n"
        '#ifdef __cplusplus\nextern "C" {\n#endif\n\n'
        "/// For fuzzy_evaluate(): the words of a fuzzy_table_t.\n"
        f"extern const uint32_t {name}_table[{len(table_words(compiled))}];\n{straight}\n"
        "#ifdef __cplusplus\n}\n#endif\n\n#endif\n"
    )


def source_c(compiled: CompiledBase, name: str, banner: str) -> str:
    """Table, and straight-line function where the base has one."""
    parts = [f'{banner}#include "{name}.h"\n', table_text(table_words(compiled), name)]
    if not why_not_straight(compiled):
        parts[0] += '\n#include "fuzzy_math.h"\n'
        parts.append(straight_line_c(compiled, name))
    return "\n".join(parts)
