"""What somebody may have meant by a name that there is not."""

from collections.abc import Iterable
from difflib import get_close_matches

ALIKE = 0.6  # of difflib's ratio


def meant(word: str, names: Iterable[str]) -> str:
    """ "; did you mean 'NAME'?" where one of the names is near, else nothing."""
    lower = {name.lower(): name for name in names}
    near = get_close_matches(word.lower(), list(lower), 1, ALIKE)
    return f"; did you mean '{lower[near[0]]}'?" if near else ""


def listed(word: str, names: Iterable[str]) -> str:
    """ "there are: A, B", and which of them may have been meant."""
    known = list(names)
    return f"there are: {', '.join(known)}{meant(word, known)}"
