"""Libraries that are heavy and for one thing each: extras of the package (pyproject.toml)."""

from collections.abc import Iterator
from contextlib import contextmanager

from quiesce.base.errors import UsageError
from quiesce.base.paths import is_installed

# What a checkout does beyond its own environment, which has the other ones.
BY_HAND = {
    "search": ".venv/bin/python -m pip install --require-hashes -r tools/requirements-search.txt"
}


@contextmanager
def extra(name: str, wanted_by: str) -> Iterator[None]:
    """Around imports of an extra: UsageError that says what to install where one fails."""
    try:
        yield
    except ImportError as error:
        how = BY_HAND.get(name, "./tools/setup python")
        if is_installed():
            how = f"pip install 'quiesce[{name}]'"
        raise UsageError(
            f"{wanted_by} needs the extra '{name}' ({error.name} is missing); install it: {how}"
        ) from None
