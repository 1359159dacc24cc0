"""A browser on the page of `quiesce live`: a program for the Python of the benchmarks' peers.

    drive_page.py CHROMIUM ADDRESS [--size WIDTHxHEIGHT] [--dark] [--axe FILE]

Opens the page, then does what lines on stdin say and answers each with a line of JSON:

    draw SECONDS     the eight signals at 1 kHz; what was drawn of them in that time
    click            clicks STOP; when, in ms since 1970 by the browser's clock
    key              the same by the Esc key
    press SELECTOR   clicks that; once it can be
    choose SELECTOR VALUE, fill SELECTOR TEXT    without a space in that selector
    attach SELECTOR FILE    chooses that file, as from a dialog
    text SELECTOR    its text
    fetch SELECTOR   what the link leads to: status and length
    painted SELECTOR how many colours a canvas has
    said             what the page says of its bus and of STOP, and whether STOP can be clicked
    axe              what axe-core finds
    shot FILE        a picture
    offline          no network any more; online: again
"""

import argparse
import json
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

from playwright.sync_api import Page, sync_playwright

SETTLE_ms = 3000
PATIENCE_ms = 120_000  # on a machine with other work
DRAW = """async ([seconds]) => {
  const { samples, show } = quiesceLive;
  const sleep = (ms) => new Promise((done) => setTimeout(done, ms));
  show(FAST);
  await sleep(SETTLE);
  const tracks = FAST.map((one) => samples.track(one));
  const before = tracks.map((one) => one.drawn);
  samples.ages_ms.fill(0);
  samples.lost = 0;
  const start_ms = performance.now();
  await sleep(1000 * seconds);
  const took_s = (performance.now() - start_ms) / 1000;
  const drawn = tracks.map((one, i) => one.drawn - before[i]);
  const undrawn = tracks.map((one) => one.count - one.drawn);
  return { took_s, drawn, undrawn, lost: samples.lost, ages_ms: Array.from(samples.ages_ms) };
}"""
# The numbers of the series, from what the page was told.
FAST = """() => quiesceLive.series()
  .filter((one) => ["CurrentDemand", "RawSample"].includes(one.message)).map((one) => one.number)"""
CLICKED = """() => {
  globalThis.pressed_ms = null;
  const note = () => { globalThis.pressed_ms = performance.timeOrigin + performance.now(); };
  document.getElementById("stop").addEventListener("click", note, { capture: true, once: true });
  addEventListener("keydown", note, { capture: true, once: true });
}"""
SAID = """() => ({
  bus: document.getElementById("bus").textContent,
  stop: document.getElementById("stop-said").textContent,
  is_enabled: !document.getElementById("stop").disabled,
})"""
FETCH = """async (link) => {
  const answer = await fetch(link.href);
  return { status: answer.status, length: (await answer.arrayBuffer()).byteLength };
}"""
PAINTED = """(canvas) => {
  const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
  return new Set(new Uint32Array(data.buffer)).size;
}"""
AXE = """async () => (await axe.run({ resultTypes: ["violations"] })).violations
  .map((one) => [one.impact, one.id, one.nodes.length, one.nodes[0].html.slice(0, 160)])"""


class Driver:
    """One page and what can be done with it."""

    def __init__(self, page: Page, axe: Path | None) -> None:
        self.page = page
        self.axe_text = axe.read_text(encoding="utf-8") if axe else ""
        self.errors: list[str] = []
        page.on("pageerror", lambda error: self.errors.append(str(error)))

    def draw(self, seconds: str) -> Any:
        fast = json.dumps(self.page.evaluate(FAST))
        code = DRAW.replace("FAST", fast).replace("SETTLE", str(SETTLE_ms))
        return {**self.page.evaluate(code, [float(seconds)]), "errors": self.errors}

    def click(self) -> Any:
        return self._pressed(lambda: self.page.click("#stop"))

    def key(self) -> Any:
        return self._pressed(lambda: self.page.keyboard.press("Escape"))

    def _pressed(self, press: Callable[[], None]) -> Any:
        self.page.evaluate(CLICKED)
        press()
        return {"pressed_ms": self.page.evaluate("() => globalThis.pressed_ms")}

    def press(self, *selector: str) -> Any:
        self.page.click(" ".join(selector))
        return {}

    def choose(self, selector: str, value: str) -> Any:
        self.page.select_option(selector, value)
        return {}

    def fill(self, selector: str, *words: str) -> Any:
        self.page.fill(selector, " ".join(words))
        self.page.press(selector, "Tab")
        return {}

    def attach(self, selector: str, file: str) -> Any:
        self.page.set_input_files(selector, file)
        return {}

    def text(self, *selector: str) -> Any:
        return {"text": self.page.text_content(" ".join(selector)), "errors": self.errors}

    def fetch(self, *selector: str) -> Any:
        return self.page.eval_on_selector(" ".join(selector), FETCH)

    def painted(self, *selector: str) -> Any:
        return self.page.eval_on_selector(" ".join(selector), PAINTED)

    def said(self) -> Any:
        return {**self.page.evaluate(SAID), "errors": self.errors}

    def axe(self) -> Any:
        self.page.evaluate(self.axe_text)
        return self.page.evaluate(AXE)

    def shot(self, file: str) -> Any:
        self.page.screenshot(path=file)
        return {}

    def offline(self) -> Any:
        self.page.context.set_offline(True)
        return {}

    def online(self) -> Any:
        self.page.context.set_offline(False)
        return {}


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("chromium")
    parser.add_argument("address")
    parser.add_argument("--size", default="1280x900")
    parser.add_argument("--dark", action="store_true")
    parser.add_argument("--axe", type=Path)
    args = parser.parse_args()
    width, height = map(int, args.size.split("x"))
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=args.chromium, args=["--no-sandbox"])
        scheme = "dark" if args.dark else "light"
        page = browser.new_page(viewport={"width": width, "height": height}, color_scheme=scheme)
        page.set_default_timeout(PATIENCE_ms)
        driver = Driver(page, args.axe)
        page.goto(args.address)
        page.wait_for_function("() => quiesceLive.series().length > 0")
        print(json.dumps("ready"), flush=True)
        for line in sys.stdin:
            do, *words = line.split()
            print(json.dumps(getattr(driver, do)(*words)), flush=True)
        browser.close()


if __name__ == "__main__":
    main()
