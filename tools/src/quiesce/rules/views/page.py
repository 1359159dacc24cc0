"""The HTML pages of `quiesce rules`: each needs nothing beside itself."""

import html
from collections.abc import Sequence

from quiesce.report.html import document, image, section


def picture(title: str, note: str, svg: str) -> str:
    return section(title, html.escape(note), image(svg, title))


def make_page(title: str, lead: str, parts: Sequence[str]) -> str:
    return document(
        title,
        f"""<h1>{html.escape(title)}</h1>
<p class="lead">{html.escape(lead)}</p>
{"".join(parts)}""",
    )
