"""How HTML pages look to a browser: a program of its own, for the Python of the benchmarks' peers.

    look_at_pages.py CHROMIUM AXE PAGE... [--shots FOLDER]

Each page at the width of a phone and of a desk, light and dark. Prints one JSON object: by page and
mode what is wrong, a line each. AXE: axe-core's axe.min.js; FOLDER gets a picture of each.
"""

import argparse
import json
from collections.abc import Iterator
from pathlib import Path

from playwright.sync_api import Page, sync_playwright

WIDTHS_px = (390, 1280)
SCHEMES = ("light", "dark")
HEIGHT_px = 844

LOOK = Path(__file__).with_suffix(".js").read_text(encoding="utf-8")
AXE = """async () => (await axe.run({resultTypes: ['violations']})).violations
  .filter(v => v.id === 'color-contrast' || ['serious', 'critical'].includes(v.impact))
  .map(v => `axe ${v.id}: ${v.nodes.length} times, ${v.nodes[0].html.slice(0, 120)}`)"""


def modes() -> Iterator[tuple[int, str]]:
    yield from ((width, scheme) for width in WIDTHS_px for scheme in SCHEMES)


def complaints(page: Page, file: Path, axe: str) -> list[str]:
    page.goto(file.resolve().as_uri())
    found = page.evaluate(LOOK, page.viewport_size["width"])
    page.evaluate(axe)
    return [*found, *page.evaluate(AXE)]


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("chromium")
    parser.add_argument("axe", type=Path)
    parser.add_argument("pages", nargs="+", type=Path)
    parser.add_argument("--shots", type=Path)
    args = parser.parse_args()
    axe = args.axe.read_text(encoding="utf-8")
    found = {}
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=args.chromium, args=["--no-sandbox"])
        for width, scheme in modes():
            size = {"width": width, "height": HEIGHT_px}
            page = browser.new_page(viewport=size, color_scheme=scheme, is_mobile=width < 500)
            for file in args.pages:
                mode = f"{file.parent.name}/{file.name} {width} px {scheme}"
                found[mode] = complaints(page, file, axe)
                if args.shots:
                    shot = args.shots / f"{file.parent.name}_{width}_{scheme}.png"
                    page.screenshot(path=shot, full_page=True)
        browser.close()
    print(json.dumps(found, indent=1))


if __name__ == "__main__":
    main()
