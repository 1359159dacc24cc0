"""What a judge of accessibility finds on the page, on a desk and on a phone, light and dark."""

import tempfile
import time
from pathlib import Path
from typing import Any

from PIL import Image

from quiesce_benchmarks.live.browser import Browser, opened
from quiesce_benchmarks.live.rig import on_network
from quiesce_benchmarks.part import Effort, Measured

TITLE = "access: axe-core on the page, at work and stopped"
FIGURES = (("a11y_serious", "1", 0.0, "lower"),)
SIZES = ("1280x900", "390x844")
SERIOUS = ("serious", "critical")
FULL_S = 11  # until the charts are full
STOPPED_S = 2
COLORS = 64  # of the picture of docs/howto


def measure(effort: Effort) -> Measured:
    found = {}
    folder = effort.folder.resolve()
    with tempfile.TemporaryDirectory() as name, on_network(Path(name), "--raw") as (_, _, page):
        time.sleep(FULL_S)
        for size in SIZES:
            for scheme in ("light", "dark"):
                options = ("--dark",) if scheme == "dark" else ()
                with opened(page.address, "--size", size, *options) as browser:
                    picture = folder / f"page_{size}_{scheme}.png"
                    found[f"{size} {scheme}"] = looked_at(browser, picture)
        with opened(page.address) as browser:
            browser.do("click")
            found["stopped"] = looked_at(browser, folder / "stopped.png")
    shrink(effort.folder / f"page_{SIZES[0]}_light.png", effort.folder / "live.png")
    serious = [one for ones in found.values() for one in ones if one[0] in SERIOUS]
    return Measured({"a11y_serious": float(len(serious))}, {"found": found})


def looked_at(browser: Browser, picture: Path) -> Any:
    time.sleep(STOPPED_S)
    browser.do("shot", picture)
    return browser.do("axe")


def shrink(picture: Path, to: Path) -> None:
    """For a page of the documentation."""
    Image.open(picture).convert("RGB").quantize(COLORS).save(to, optimize=True)
