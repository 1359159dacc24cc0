"""Tables of all kinds that a law is made of, by their first word."""

from collections.abc import Sequence
from pathlib import Path

from quiesce.base.errors import UsageError
from quiesce.base.paths import shown
from quiesce.law.forms import friction, fuzzy_signals, linear, network, polynomial, signs
from quiesce.law.forms.friction import FrictionTable
from quiesce.law.forms.fuzzy_signals import FuzzySignalsTable
from quiesce.law.forms.linear import LinearTable
from quiesce.law.forms.network import NetworkTable
from quiesce.law.forms.polynomial import PolynomialTable
from quiesce.law.forms.signs import SignsTable
from quiesce.law.words import read_file

Table = (
    LinearTable | SignsTable | FrictionTable | PolynomialTable | FuzzySignalsTable | NetworkTable
)

FORMS = {form.MAGIC: form for form in (linear, signs, friction, polynomial, fuzzy_signals, network)}


def table_of_words(words: Sequence[int]) -> Table:
    """ValueError, in one line, where the firmware refuses them."""
    form = FORMS.get(words[0]) if words else None
    if form is None:
        known = ", ".join(
            f"{form.__name__.rpartition('.')[2]} 0x{m:08x}" for m, form in FORMS.items()
        )
        begins = f"begins with 0x{words[0]:08x}" if words else "is empty"
        raise ValueError(f"it {begins}; tables of laws begin with: {known}")
    return form.read(words)


def read_table(file: Path) -> Table:
    """Of a law, or of tracker network. UsageError, in one line, where it is not one."""
    words = read_file(file)
    try:
        return (
            network.read_tracker(words)
            if words[:1] == [network.TRACK_MAGIC]
            else table_of_words(words)
        )
    except ValueError as error:
        raise UsageError(f"{shown(file)}: {error}")
