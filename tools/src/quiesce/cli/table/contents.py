"""What is in a table, in words: the reader and the describer of each kind."""

from collections.abc import Callable, Sequence
from pathlib import Path

from quiesce.base.errors import UsageError
from quiesce.base.paths import shown
from quiesce.table.file import ANY_BOARD, TableFile
from quiesce.table.kinds import BANK, INVERSE_NETWORK, KINDS, LEARNT, MAP, PULSES, RULES, Kind
from quiesce.table.words import opened

Words = Sequence[int]


# Imported late: most readers need numpy, some scipy, and a table is of one kind.


def _rules(words: Words) -> str:
    from quiesce.rules.integers.rule_text import described
    from quiesce.rules.integers.rule_words import read_rules
    from quiesce.rules.surface.text import described_surface
    from quiesce.rules.surface.words import is_surface, read_surface

    return (
        described_surface(read_surface(words))
        if is_surface(words)
        else described(read_rules(words))
    )


def _pulses(words: Words) -> str:
    from quiesce.tune.phase_words import described_pulses, law_of_words

    return described_pulses(law_of_words(words))


def _maps(words: Words) -> str:
    from quiesce.damper.force_map import maps_of_words
    from quiesce.damper.report.table_text import described_maps

    return described_maps(maps_of_words(words))


def _banks(words: Words) -> str:
    from quiesce.damper.bank.table import banks_of_words
    from quiesce.damper.report.table_text import described_banks

    return described_banks(banks_of_words(words))


def _tracker_network(words: Words) -> str:
    from quiesce.law.describe import described
    from quiesce.law.forms.network import read_tracker

    return described(read_tracker(words))


def _learnt(words: Words) -> str:
    from quiesce.tune.learnt_words import described_learnt, learnt_of_words

    return described_learnt(learnt_of_words(words))


def _law(words: Words) -> str:
    from quiesce.law.describe import described
    from quiesce.law.tables import table_of_words

    return described(table_of_words(words))


_OTHERS: dict[Kind, Callable[[Words], str]] = {
    RULES: _rules,
    PULSES: _pulses,
    MAP: _maps,
    BANK: _banks,
    INVERSE_NETWORK: _tracker_network,
    LEARNT: _learnt,
}


def kind_of(words: Words) -> Kind | None:
    """None: of a law or tracker that this program does not know."""
    return KINDS.get(words[0])


def kind_text(words: Words) -> str:
    kind = kind_of(words)
    return f"{kind.name}, version {kind.version}" if kind else f"0x{words[0]:08x}, not known here"


def contents_of(file: Path, table: TableFile) -> str:
    """Empty for a kind that is not known. UsageError where it is damaged."""
    kind = kind_of(table.words)
    try:
        opened(table.words)
        return _OTHERS.get(kind, _law)(table.words) if kind else ""
    except ValueError as error:
        raise UsageError(f"{shown(file)}: {error}")


def board_text(board: int) -> str:
    return "any" if board == ANY_BOARD else f"0x{board:08x}"
