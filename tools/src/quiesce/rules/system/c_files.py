"""A compiled system as C: its table, and a header."""

from quiesce.rules.integers.c_files import table_text
from quiesce.rules.system.compile import CompiledSystem, ScaledSystem


def units_text(compiled: ScaledSystem) -> list[str]:
    """What the integers stand for, a line a variable."""
    lines = [
        f"input  {variable.name}: {float(axis.lsb):.9g} a count from {float(axis.origin):g}; "
        f"universe {variable.minimum:g} .. {variable.maximum:g}"
        for variable, axis in zip(compiled.system.inputs, compiled.axes, strict=True)
    ]
    outputs = zip(compiled.system.outputs, compiled.output_axes, compiled.defaults, strict=True)
    return lines + [
        f"output {output.name}: {float(axis.lsb):.9g} a count from {float(axis.origin):g}; "
        f"default {default:g} ({round((default - float(axis.origin)) / float(axis.lsb))} counts)"
        for output, axis, default in outputs
    ]


def call_text(name: str) -> str:
    return (
        f"fuzzy_system_evaluate((const fuzzy_system_t *)(const void *){name}_table, input, output)"
    )


def header_c(compiled: CompiledSystem, name: str, banner: str) -> str:
    return header_text(
        compiled, name, f"{banner}/// Fuzzy system {compiled.system.name} in integers "
        "(fuzzy_system.h):\n", '"fuzzy_system.h"',
        "/// For fuzzy_system_evaluate(): the words of a fuzzy_system_t.\n"
        f"extern const uint32_t {name}_table[{len(compiled.words)}];\n",
    )  # fmt: skip


def header_text(
    compiled: ScaledSystem, name: str, heading: str, included: str, declaration: str
) -> str:
    guard = f"{name.upper()}_H"
    units = "".join(f"///   {line}\n" for line in units_text(compiled))
    return (
        f"{heading}{units}#ifndef {guard}\n#define {guard}\n\n#include {included}\n\n"
        f'#ifdef __cplusplus\nextern "C" {{\n#endif\n\n{declaration}\n'
        "#ifdef __cplusplus\n}\n#endif\n\n#endif\n"
    )


def source_c(compiled: CompiledSystem, name: str, banner: str) -> str:
    return f'{banner}#include "{name}.h"\n\n{table_text(compiled.words, name)}'
