#!/usr/bin/env python3
"""Write the figures and tables of README.md and docs/ from the committed results (docs/results).

Without options: between the marks of every page. `--check` writes nothing and exits 1 where a page
differs. `--record PATH...` first takes in new results: a report folder of ./tools/hil, NAME.json of
`./tools/benchmark NAME`, or the word `node` (counts the ticks of the node image, build/mps2).
"""

import argparse
import json
import subprocess
import sys
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "tools/src"), str(ROOT / "tools/benchmarks")]

from quiesce_benchmarks.house.committed import FOLDER, Committed, load  # noqa: E402
from quiesce_benchmarks.house.pages import figures_inconsistent, fill, pages  # noqa: E402

BENCH = ROOT / "build/host/sim_hil/quiesce_bench"
NODE_IMAGE = ROOT / "build/mps2/tests/unit/mps2/node_cost.elf"
NODE_TICKS = "20000"
# Of a benchmark's context: what the pages' tables show.
KEPT = {
    "board": ("seed", "quick", "reported"),
    "campaign": ("seed", "quick", "reported"),
    "control": ("seed", "quick", "settings", "cost"),
    "controller": ("golden_words", "compared_words", "off_worst_instr"),
    "fuzzy": ("seed", "quick", "engines", "peers", "host_instr", "ratios"),
    "install": ("seed", "quick", "reported"),
    "laws": ("seed", "quick", "reported"),
    "lock": ("seed", "quick", "reported"),
    "papers": ("seed", "quick", "reported"),
    "signal": ("seed", "quick", "settings", "accuracy", "plant_steps", "cost"),
    "tables": ("seed", "quick", "reported"),
}
# What the image counts for a first word of 0, 1, 2.
NODE_PARTS = ("messages", "one_received", "tick")


def source_tree() -> str:
    """Git's name for the firmware that was measured: `git rev-parse COMMIT:firmware` finds it."""
    command = ["git", "-C", str(ROOT), "rev-parse", "--short=12", "HEAD:firmware"]
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout.strip()


def hil_result(folder: Path) -> dict[str, Any]:
    metrics = json.loads((folder / "metrics.json").read_text())
    del metrics["realtime_factor"]  # of the machine and of what else it did
    return {"command": "./tools/hil", **metrics, "table": (folder / "table.txt").read_text()}


def benchmark_result(file: Path) -> dict[str, Any]:
    result = json.loads(file.read_text())
    command = f"./tools/benchmark {result['bench']}"
    keys = KEPT.get(result["bench"], ("seed", "quick"))
    kept = {key: result["context"][key] for key in keys if key in result["context"]}
    return {"command": command, **result, "context": kept}


def node_result() -> dict[str, Any]:
    figures = []
    for word, part in enumerate(NODE_PARTS):
        command = [str(BENCH), "count", "--image", str(NODE_IMAGE), "--word", str(word)]
        command += ["--word", NODE_TICKS]
        run = subprocess.run(command, check=True, capture_output=True, text=True)
        counts = json.loads(run.stdout)
        for key in ("median", "worst"):
            figures.append({"name": f"{part}_{key}", "value": counts[key], "unit": "instr"})
    shown = "quiesce_bench count --image node_cost.elf --word 0, 1, 2 --word " + NODE_TICKS
    return {"command": shown, "bench": "node", "figures": figures}


def record(path: str) -> None:
    if path == "node":
        result = node_result()
    elif Path(path).is_dir():
        result = hil_result(Path(path))
        picture = (Path(path) / "picture.svg").read_text()
        (ROOT / FOLDER / "figures/hil.svg").write_text(picture)
    else:
        result = benchmark_result(Path(path))
    name = result.get("bench", "hil")
    text = json.dumps({"firmware": source_tree(), **result}, indent=1)
    (ROOT / FOLDER / f"{name}.json").write_text(text + "\n")


def write(committed: Committed) -> None:
    for page in pages(ROOT):
        text = page.read_text()
        filled = fill(text, committed)
        if filled != text:
            page.write_text(filled)


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--check", action="store_true", help="compare only, exit 1 on a difference")
    parser.add_argument("--record", metavar="PATH", nargs="+", default=[], help="new results")
    args = parser.parse_args()
    for path in args.record:
        record(path)
    if not args.check:
        write(load(ROOT))
    wrong = figures_inconsistent(ROOT)
    for line in wrong:
        print(line, file=sys.stderr)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
