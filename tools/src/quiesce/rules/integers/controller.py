"""Rule bases for the controller: Hz and m/s2 in, A out in the file; uHz, um/s2 and mA in the
table."""

from collections.abc import Mapping

from quiesce.base.errors import UsageError
from quiesce.rules.integers.compile import compile_base
from quiesce.rules.integers.compiled import CompiledBase
from quiesce.rules.integers.table import table_words
from quiesce.rules.model import RuleBase
from quiesce.table.file import table_bytes

INPUT_LSB = (1e-6, 1e-6)
OUTPUT_LSB = (1e-3,)


def require_controller_shape(base: RuleBase) -> None:
    if len(base.inputs) != 2 or len(base.outputs) != 1:
        raise UsageError(
            f"{base.name} has {len(base.inputs)} inputs and {len(base.outputs)} outputs; the "
            "controller's rules have two inputs, frequency (Hz) and RMS acceleration (m/s2), and "
            "one output, current (A)"
        )


def compile_for_controller(
    base: RuleBase, defaults: Mapping[str, float] | None = None
) -> CompiledBase:
    """defaults: as in compile_base. UsageError where the controller does not take such rules."""
    require_controller_shape(base)
    return compile_base(base, list(INPUT_LSB), list(OUTPUT_LSB), defaults)


def controller_file(base: RuleBase) -> bytes:
    """Its table file. UsageError where it is too long, too."""
    try:
        return table_bytes(table_words(compile_for_controller(base)))
    except ValueError as error:
        raise UsageError(f"{base.name}: {error}")
