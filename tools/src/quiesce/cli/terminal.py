"""Text as a terminal shows it."""

import os
import sys

# A line of dashes, and the line above it.
RULE, HEAD = r"(?m)^-+(?: +-+)*$", r"(?m)^.*(?=\n-+(?: +-+)*$)"


def show(text: str) -> None:
    """On stdout. Heads of tables stand out where that is a terminal; NO_COLOR and TERM=dumb leave
    the text as it is."""
    if not sys.stdout.isatty() or os.environ.get("NO_COLOR") or os.environ.get("TERM") == "dumb":
        print(text)
        return
    from rich.console import Console
    from rich.text import Text

    shown = Text(text)
    shown.highlight_regex(HEAD, "bold")
    shown.highlight_regex(RULE, "dim")
    Console(highlight=False).print(shown, soft_wrap=True)
