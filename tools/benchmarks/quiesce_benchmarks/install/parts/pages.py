"""The HTML pages in a browser, on a phone and on a desk, light and dark."""

import json
import shlex
import sys
import tempfile
from pathlib import Path
from shutil import which

from quiesce.base.errors import UsageError
from quiesce.base.table import format_table

from quiesce_benchmarks.fuzzy.peers import BROWSER, PYTHON, built_peer
from quiesce_benchmarks.install.examples import EXAMPLES
from quiesce_benchmarks.install.outside import run
from quiesce_benchmarks.part import Effort, Measured

TITLE = "pages: in a browser, on a phone and on a desk, light and dark"
# By command: what is typed after its example, and its page.
PAGES = {
    "hil": ("--out hil", "hil/index.html"),
    "rules show": ("--out show", "show/index.html"),
    "identify": ("", "found/report.html"),
    "tune": ("", "tuned/report.html"),
}
NEEDED = ("new plant", "rules convert", "identify example")  # what these examples read
MODES = 4
FIGURES = (("report_phone_ok", "1", float(MODES * len(PAGES)), "higher"),)
LOOK = Path(__file__).parents[1] / "look_at_pages.py"
TIMEOUT_s = 1800
SHOWN = 5  # lines of a page in a mode


def browser() -> tuple[str, str, str]:
    """Python that drives it, Chromium, axe-core. UsageError where one of them cannot be had."""
    axe = built_peer(BROWSER)
    chromium = which("chromium")
    if chromium is None:
        raise UsageError("chromium is not installed; run ./tools/benchmarks/fetch_peers browser")
    return str(built_peer(PYTHON)), chromium, str(axe)


def make_pages(folder: Path) -> list[str]:
    for name, words in EXAMPLES:
        if name in PAGES or name in NEEDED:
            more = PAGES.get(name, ("",))[0]
            typed = shlex.split(f"{name} {words} {more}")
            run(sys.executable, "-m", "quiesce", *typed, folder=folder, timeout_s=TIMEOUT_s)
    return [page for _, page in PAGES.values()]


def measure(effort: Effort) -> Measured:
    python, chromium, axe = browser()
    with tempfile.TemporaryDirectory() as name:
        pages = make_pages(Path(name))
        shots = effort.folder / "pages"
        shots.mkdir(parents=True, exist_ok=True)
        look = [python, "-I", str(LOOK), chromium, axe, *pages, "--shots", str(shots.resolve())]
        found = json.loads(run(*look, folder=Path(name), timeout_s=TIMEOUT_s))
    rows = [[mode, line] for mode, lines in found.items() for line in lines[:SHOWN]]
    return Measured(
        {"report_phone_ok": float(sum(not lines for lines in found.values()))},
        {"pages": found},
        (format_table(["page", "what is wrong"], rows, left=(0, 1)),) if rows else (),
    )
