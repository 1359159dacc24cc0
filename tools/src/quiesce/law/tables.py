"""Tables of all kinds that a law is made of, by their first word."""

from collections.abc import Sequence

from quiesce.law.forms import friction, fuzzy_signals, linear, network, polynomial, signs
from quiesce.law.forms.friction import FrictionTable
from quiesce.law.forms.fuzzy_signals import FuzzySignalsTable
from quiesce.law.forms.linear import LinearTable
from quiesce.law.forms.network import NetworkTable
from quiesce.law.forms.polynomial import PolynomialTable
from quiesce.law.forms.signs import SignsTable

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
