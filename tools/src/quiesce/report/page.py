"""HTML pages: templates beside the modules that fill them, on what report/*.j2 has for all.

A page needs nothing beside itself. Its data is prepared in Python, its words stand in its template.
"""

import colorsys
import functools
import re
from hashlib import sha256
from typing import Any

from quiesce.base.paths import typed

PAPER, INK = "#14191f", "#e3e8ed"  # in dark mode
LIGHT_ENOUGH = 0.3  # luminance of a curve's colour that stays as it is there


@functools.cache
def environment() -> Any:
    """Templates by their path in the package. Imported late: most commands make no page."""
    from jinja2 import Environment, PackageLoader, StrictUndefined

    made = Environment(
        loader=PackageLoader("quiesce", ""),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    made.filters["inline"] = inline
    made.globals |= {"typed": typed, "dark_paper": PAPER, "dark_ink": INK}
    made.globals["ui"] = made.get_template("report/macros.html.j2").module
    return made


def render(template: str, **data: Any) -> str:
    """template: its path in the package; jinja2.UndefinedError where it wants what `data` lacks."""
    return environment().get_template(template).render(data)


def inline(svg: str) -> Any:
    """A picture of matplotlib's as part of a page: with ids that no other picture has, and colours
    for dark mode unless it holds an image, whose colours are fixed."""
    from markupsafe import Markup

    svg = re.sub(
        r'<!--.*?-->|<metadata>.*?</metadata>|<style.*?</style>| xmlns\S*="\S+"',
        "",
        svg,
        flags=re.S,
    )
    svg = re.sub(r">\s+<", "><", svg[svg.index("<svg") :])
    mark = sha256(svg.encode()).hexdigest()[:8]
    used = set(re.findall(r'#([pm]\w+)(?=[)"])', svg))
    svg = re.sub(r' id="(.*?)"', lambda m: f' id="{m[1]}-{mark}"' * (m[1] in used), svg)
    svg = re.sub(r'#([pm]\w+)(?=[)"])', rf"#\1-{mark}", svg)
    return Markup(svg if "<image" in svg else in_both_modes(svg))


def in_both_modes(svg: str) -> str:
    """Each colour becomes a variable that dark mode sets."""
    colours = sorted(set(re.findall(r"(?<=: #)[0-9a-f]{6}", svg)))
    svg = re.sub(r"(?<=: )#([0-9a-f]{6})", r"var(--c\1,#\1)", svg)
    dark = "".join(f"--c{colour}:{in_the_dark(colour)};" for colour in colours)
    style = f"<style>@media (prefers-color-scheme:dark){{svg{{{dark}}}}}</style>"
    return svg.replace(">", f">{style}", 1)


def in_the_dark(colour: str) -> str:
    """Of a grey what is as far between dark paper and ink; another colour light enough to see."""
    rgb = [int(colour[i : i + 2], 16) / 255.0 for i in (0, 2, 4)]
    _, lightness, saturation = colorsys.rgb_to_hls(*rgb)
    if saturation < 0.2:
        return mixed(PAPER, INK, (1.0 - lightness) ** 0.75)
    luminance = sum(part * one**2.2 for part, one in zip((0.21, 0.72, 0.07), rgb, strict=True))
    return mixed(f"#{colour}", "#ffffff", 0.0 if luminance > LIGHT_ENOUGH else 0.35)


def mixed(one: str, other: str, part: float) -> str:
    """part: of the other colour, 0..1."""
    pairs = ((int(one[i : i + 2], 16), int(other[i : i + 2], 16)) for i in (1, 3, 5))
    return "#" + "".join(f"{round(a + part * (b - a)):02x}" for a, b in pairs)
