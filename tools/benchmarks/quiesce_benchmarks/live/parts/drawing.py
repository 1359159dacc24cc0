"""Eight signals at 1 kHz in a browser: every sample drawn, how old, at what cost."""

import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np

from quiesce_benchmarks.live.browser import opened
from quiesce_benchmarks.live.rig import Node, Page, node_program, on_network
from quiesce_benchmarks.live.usage import busy, cpu_s, rss_MB
from quiesce_benchmarks.part import Effort, Measured

TITLE = "drawing: eight signals at 1 kHz in Chromium, on UDP multicast and on a pty"
# CPU and age are of a machine and what else it does: reported, never failing.
FIGURES = (
    ("page_samples_lost", "1", 0.0, "lower"),
    ("page_age_ms_p95", "ms", 60.0, "lower", False),
    ("page_cpu_pct", "%", 15.0, "lower", False),
    ("page_rss_MB", "MB", 120.0, "lower"),
)
DRAW_s, QUICK_s = 60, 10
LEAST_SHARE = 0.95  # of 1 kHz, or the machine was too busy to tell


def measure(effort: Effort) -> Measured:
    seconds = QUICK_s if effort.is_quick else DRAW_s
    with tempfile.TemporaryDirectory() as name:
        found = {"udp_multicast": on_multicast(Path(name), seconds)}
        found["pty"] = on_pty(Path(name), seconds)
    worst = {
        figure: max(one[figure] for one in found.values())
        for figure in ("page_samples_lost", "page_age_ms_p95", "page_cpu_pct", "page_rss_MB")
    }
    return Measured(worst, {"seconds": seconds, "machine": busy(), **found})


def on_multicast(folder: Path, seconds: int) -> dict[str, Any]:
    with on_network(folder, "--raw") as (_, _, page):
        return drawn(page, seconds)


def on_pty(folder: Path, seconds: int) -> dict[str, Any]:
    node = Node(node_program(), folder)
    node.start()
    page = Page(folder, "--bus", node.bus, "--raw")
    try:
        return drawn(page, seconds)
    finally:
        page.end()
        node.stop()


def drawn(page: Page, seconds: int) -> dict[str, Any]:
    """What a browser drew, the worse of the two buses counts."""
    pid = page.process.pid
    with opened(page.address) as browser:
        browser.do("draw", 0)  # the page settles, its history is drawn
        before_s, start_s = cpu_s(pid), time.monotonic()
        found = browser.do("draw", seconds)
        took_s = time.monotonic() - start_s
        used_s = cpu_s(pid) - before_s
    ages = np.array(found["ages_ms"])
    share = min(found["drawn"]) / (1000 * found["took_s"])
    return {
        "page_samples_lost": float(found["lost"]),
        "page_age_ms_p95": float(np.searchsorted(np.cumsum(ages), 0.95 * ages.sum())),
        "page_cpu_pct": 100 * used_s / took_s,
        "page_rss_MB": rss_MB(pid),
        "drawn": found["drawn"],
        "share_of_1_kHz": share,
        "is_at_full_rate": share >= LEAST_SHARE,
        "page_errors": found["errors"],
    }
