"""The page of `quiesce live --sim`: what a judge of accessibility finds, what its rig does, a
picture and an animation of it for the documentation."""

import os
import tempfile
import time
from pathlib import Path
from typing import Any

from PIL import Image

from quiesce_benchmarks.live.browser import Browser, opened
from quiesce_benchmarks.live.commands import heard, say
from quiesce_benchmarks.live.parts.access import SERIOUS, shrink
from quiesce_benchmarks.live.rig import Page
from quiesce_benchmarks.part import Effort, Measured

TITLE = "sim: a rig in the computer, with control off and on"
FIGURES = (
    ("sim_a11y_serious", "1", 0.0, "lower"),
    ("sim_displacement_pct", "%", None, "lower"),
    ("sim_overruns_pct", "%", None, "lower"),
)
SIZES = ("1280x900", "390x844")
OFF_S, ON_S = 4.0, 6.0  # a whole window of the comparison each, and the charts' change
FRAME_S = 1.0
WIDTH = 640
FILM_COLORS = 32


def measure(effort: Effort) -> Measured:
    folder = effort.folder.resolve()
    found: dict[str, Any] = {}
    with tempfile.TemporaryDirectory() as name:
        page = Page(Path(name), "--sim")
        try:
            with opened(page.address, "--size", SIZES[0]) as browser:
                frames = filmed(page, browser, folder)
                found[SIZES[0]] = browser.do("axe")
            with page.viewer() as viewer:
                state = heard(viewer, "state", lambda one: is_compared(one["rig"]))
            with opened(page.address, "--size", SIZES[1], "--dark") as browser:
                found[SIZES[1]] = browser.do("axe")
        finally:
            page.end()
    shrink(frames[-1], folder / "rig.png")
    animate(frames, folder / "rig.gif")
    serious = [one for ones in found.values() for one in ones if one[0] in SERIOUS]
    return Measured(values(state["rig"], len(serious)), {"found": found, "rig": state["rig"]})


def values(rig: dict[str, Any], serious: int) -> dict[str, float | None]:
    off, on = rig["vibration"]["off"], rig["vibration"]["on"]
    return {
        "sim_a11y_serious": float(serious),
        "sim_displacement_pct": 100.0 * on["displacement_um"] / off["displacement_um"],
        "sim_overruns_pct": 100.0 * rig["pace"]["overruns"] / rig["ticks"],
    }


def is_compared(rig: dict[str, Any]) -> bool:
    vibration = rig.get("vibration", {})
    return bool(vibration.get("on") and vibration.get("off"))


def control(page: Page, is_on: bool) -> None:
    """A viewer who comes for that alone."""
    with page.viewer() as viewer:
        say(viewer, "take")
        say(viewer, "rig", order={"control": is_on})
        heard(viewer, "state", lambda one: one["rig"].get("control") is is_on)


def filmed(page: Page, browser: Browser, folder: Path) -> list[Path]:
    """Control goes off, then on."""
    frames: list[Path] = []
    for is_on, lasts_s in ((False, OFF_S), (True, ON_S)):
        control(page, is_on)
        end_s = time.monotonic() + lasts_s
        while (now_s := time.monotonic()) < end_s:
            frames.append(folder / f"rig_{len(frames)}.png")
            browser.do("shot", frames[-1])
            time.sleep(max(0.0, now_s + FRAME_S - time.monotonic()))
    return frames


def animate(frames: list[Path], to: Path) -> None:
    """The frames become one file, and go."""
    pictures = []
    for frame in frames:
        picture = Image.open(frame).convert("RGB")
        height = picture.height * WIDTH // picture.width
        pictures.append(picture.resize((WIDTH, height)).quantize(FILM_COLORS))
        os.unlink(frame)
    first, *rest = pictures
    duration_ms = round(1000 * FRAME_S)
    first.save(to, save_all=True, append_images=rest, duration=duration_ms, loop=0, optimize=True)
