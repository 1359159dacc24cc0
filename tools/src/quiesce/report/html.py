"""What every HTML page of the project is made of; a page needs nothing beside itself."""

import base64
import html
from collections.abc import Collection, Sequence

CSS = """
:root { color-scheme: light; }
* { box-sizing: border-box; }
body { font: 15px/1.5 system-ui, "Segoe UI", Roboto, sans-serif; color: #1f2933; margin: 0;
       background: #f4f6f8; }
main { max-width: 1180px; margin: 0 auto; padding: 28px 24px 60px; background: #fff; }
h1 { font-size: 26px; margin: 0 0 4px; } h2 { font-size: 19px; margin: 40px 0 8px; }
p { max-width: 76ch; margin: 8px 0; } .lead { color: #52606d; }
.cards { display: grid; grid-template-columns: repeat(auto-fit, minmax(190px, 1fr)); gap: 12px;
         margin: 22px 0; }
.card { border: 1px solid #d9dfe5; border-radius: 8px; padding: 12px 14px; }
.card b { display: block; font-size: 22px; line-height: 1.2; }
.card.bad { border-color: #c0392b; background: #fdf1ef; }
.card span { color: #52606d; font-size: 13px; }
.wide { overflow-x: auto; }
table { border-collapse: collapse; font-size: 12.5px; font-variant-numeric: tabular-nums;
        width: 100%; }
th, td { padding: 3px 5px; text-align: right; white-space: nowrap; }
th { font-weight: 600; color: #52606d; border-bottom: 1px solid #b8c2cc; vertical-align: bottom; }
th.group { text-align: center; border-bottom: 1px solid #d9dfe5; }
td:first-child, th:first-child, td.left, th.left { text-align: left; }
tr.head td { background: #eef2f5; font-weight: 600; padding-top: 6px; }
td.ours { font-weight: 650; } td.diff { color: #7b8794; }
td.sep, th.sep { border-left: 1px solid #d9dfe5; }
img { display: block; width: 100%; height: auto; margin: 10px 0; }
pre { background: #f4f6f8; border: 1px solid #e1e6ea; border-radius: 6px; padding: 10px 12px;
      overflow-x: auto; font-size: 13px; }
"""


def document(title: str, main: str) -> str:
    """title: plain text, after the project's name; main: HTML."""
    return f"""<!doctype html>
<html lang="en"><head><meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>Quiesce: {html.escape(title)}</title><style>{CSS}</style></head><body><main>
{main}
</main></body></html>
"""


def image(svg: str, alt: str) -> str:
    if not svg:
        return ""
    data = base64.b64encode(svg.encode()).decode()
    return f'<img alt="{html.escape(alt)}" src="data:image/svg+xml;base64,{data}">'


def card(figure: str, caption: str, is_bad: bool = False) -> str:
    kind = "card bad" if is_bad else "card"
    text = f"<b>{html.escape(figure)}</b><span>{html.escape(caption)}</span>"
    return f'<div class="{kind}">{text}</div>'


def cards(parts: Sequence[str]) -> str:
    return f'<div class="cards">{"".join(parts)}</div>'


def section(title: str, note: str, picture: str) -> str:
    return f"<h2>{html.escape(title)}</h2><p>{note}</p>{picture}" if picture else ""


def preformatted(title: str, text: str) -> str:
    return f"<h2>{html.escape(title)}</h2><pre>{html.escape(text)}</pre>"


def items(lines: Sequence[str]) -> str:
    return f"<ul>{''.join(f'<li>{html.escape(line)}</li>' for line in lines)}</ul>" if lines else ""


def html_table(
    table: tuple[Sequence[str], Sequence[Sequence[str]]], left: Collection[int] = ()
) -> str:
    """Head and rows of plain text; the first column and those in `left` flush left."""
    head, rows = table

    def line(cells: Sequence[str], tag: str) -> str:
        marks = [' class="left"' if k in left else "" for k in range(len(cells))]
        body = (
            f"<{tag}{mark}>{html.escape(cell)}</{tag}>"
            for cell, mark in zip(cells, marks, strict=True)
        )
        return f"<tr>{''.join(body)}</tr>"

    body = "".join(line(row, "td") for row in rows)
    return f'<div class="wide"><table>{line(head, "th")}{body}</table></div>'
