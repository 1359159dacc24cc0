"""Libraries that are heavy and for one thing each: extras of the package (pyproject.toml)."""

from collections.abc import Iterator
from contextlib import contextmanager

from quiesce.base.errors import UsageError
from quiesce.base.paths import is_installed


@contextmanager
def extra(name: str, wanted_by: str) -> Iterator[None]:
    """Around imports of an extra: UsageError that says what to install where one fails."""
    try:
        yield
    except ImportError as error:
        how = f"pip install 'quiesce[{name}]'" if is_installed() else "./tools/setup python"
        raise UsageError(
            f"{wanted_by} needs the extra '{name}' ({error.name} is missing); install it: {how}"
        ) from None
