"""The HTML pages of `quiesce rules`: each needs nothing beside itself."""

import html
from collections.abc import Sequence

from quiesce.hil.page import CSS, image, section


def picture(title: str, note: str, svg: str) -> str:
    return section(title, html.escape(note), image(svg, title))


def preformatted(title: str, text: str) -> str:
    return f"<h2>{html.escape(title)}</h2><pre>{html.escape(text)}</pre>"


def make_page(title: str, lead: str, parts: Sequence[str]) -> str:
    return f"""<!doctype html>
<html lang="en"><head><meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>{html.escape(title)}</title><style>{CSS}</style></head><body><main>
<h1>{html.escape(title)}</h1>
<p class="lead">{html.escape(lead)}</p>
{"".join(parts)}
</main></body></html>
"""
