#!/usr/bin/env python3
"""Write a page for each published law, docs/reference/laws/NAME.md, and their lines in
docs/index.md: those of `quiesce law list`, and those of tools/gen/laws.toml, with the committed
results of `./tools/benchmark laws`.

Deterministic: the same source gives the same bytes. `--check` writes nothing and exits 1 where a
committed file differs.
"""

import argparse
import json
import re
import sys
import tomllib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "tools/src")]

from quiesce.law.recipe import Recipe, Setting  # noqa: E402
from quiesce.law.recipes import RECIPES  # noqa: E402

FOLDER = Path("docs/reference/laws")
RESULTS = Path("docs/results/laws.json")
OTHERS = Path("tools/gen/laws.toml")
INDEX = Path("docs/index.md")
LISTED = re.compile(r"(<!-- laws: [^\n]*\n).*?(\n<!-- end -->)", re.DOTALL)
BUILDING = "building of 1996, records that nobody chose on"
CAR = "quarter of a car, a road that nobody chose on"
CANTILEVER = "frozen cantilever, the four frequencies that it was tuned on"
BEST_CONSTANT = "best constant"
UNKNOWN = "not recorded yet"
SYMBOLS = """x, v and a are a body's absolute displacement, velocity and acceleration; r and v_r a
damper's stroke and its velocity, of end a less end b; F its force, above 0 where it resists a
stroke that grows."""

Reported = dict[str, dict[str, Any]]


@dataclass(frozen=True)
class Law:
    """What a page is made of. row: of the results' tables."""

    name: str
    summary: str
    equation: str
    source: str
    errata: str
    when: str
    runs_as: str
    signals: str
    make: str
    settings: tuple[Setting, ...] | None
    row: str


def of_recipe(recipe: Recipe, reported: Reported) -> Law:
    found = of_cost(recipe.name, reported) or {}
    demands = f"forces, tracker `{recipe.tracker}` or another" if recipe.tracker else "currents"
    return Law(
        recipe.name,
        recipe.summary,
        recipe.equation,
        recipe.source,
        recipe.errata,
        recipe.when,
        f"law `{found.get('law', UNKNOWN)}`, demands {demands}",
        ", ".join(found.get("signals", [UNKNOWN])),
        f"`quiesce law make {recipe.name} --board FILE -o FILE`: "
        "[use-a-published-law.md](../../howto/use-a-published-law.md).",
        recipe.settings,
        recipe.name,
    )


def of_table(one: dict[str, str]) -> Law:
    texts = {key: text for key, text in one.items() if key != "built_in"}
    return Law(**texts, settings=None, row=one.get("built_in", ""))


def page(law: Law, reported: Reported) -> str:
    parts = [
        f"# {law.name}",
        "Written by tools/gen/law_pages.py. Do not edit.",
        law.summary[:1].upper() + law.summary[1:] + ".",
        f"    {law.equation}",
        SYMBOLS,
        rows(
            ("", ""),
            [
                ("source", law.source),
                ("what is wrong there", law.errata or "nothing that was found"),
                ("when to use it", law.when),
                ("runs as", law.runs_as),
                ("signals", law.signals),
                ("how", law.make),
            ],
        ),
        *settings(law),
        "## What it costs",
        cost(law, reported),
        "## What it does",
        worth(law, reported),
    ]
    return "\n\n".join(parts) + "\n"


def rows(head: tuple[str, ...], body: list[tuple[str, ...]]) -> str:
    lines = [head, tuple("---" for _ in head), *body]
    return "\n".join(
        "| " + " | ".join(cell.replace("|", "\\|") for cell in x) + " |" for x in lines
    )


def settings(law: Law) -> list[str]:
    if law.settings is None:
        return []
    body = [
        (f"`{s.name}`", f"{s.default:g}", f"{s.low:g} .. {s.high:g}", s.help) for s in law.settings
    ]
    return ["## Settings", rows(("setting", "default", "range", ""), body)]


def of_cost(name: str, reported: Reported) -> dict[str, Any] | None:
    """With its own tracker, which is the first."""
    found: dict[str, dict[str, Any]] = reported.get("cost", {}).get("costs", {})
    return next(iter(own_rows(name, found)), None)


def cost(law: Law, reported: Reported) -> str:
    found = of_cost(law.row, reported)
    if found is None:
        text = "The tracker's is in [laws.md](../../results/laws.md), beside each law's own."
        return text if not law.row else sentence(UNKNOWN)
    body = [
        ("controller's tick with it, the worst", f"{found['tick_worst_instr']:.0f} instructions"),
        ("the law and its tracker alone, the worst", f"{found['own_worst_instr']:.0f}"),
        ("the law and its tracker alone, mean", f"{found['own_mean_instr']:.0f}"),
        ("state", f"{found['state_bytes']} bytes"),
        ("table", f"{found['table_words']} words of 4 bytes"),
    ]
    tracker = f", tracker `{found['tracker']}`" if found["tracker"] else ""
    where = f"On the emulated Cortex-M4, board `{found['rig']}`{tracker}"
    return f"{where} ([laws.md](../../results/laws.md)).\n\n{rows(('', ''), body)}"


def sentence(text: str) -> str:
    return text[:1].upper() + text[1:] + "."


@dataclass(frozen=True)
class Cell:
    """is_less_better, and the figure of the law, of the best constant current, of none."""

    where: str
    what: str
    own: float
    constant: float
    none: float
    is_less_better: bool = True

    @property
    def is_won(self) -> bool:
        sign = 1.0 if self.is_less_better else -1.0
        return sign * self.own < min(sign * self.constant, sign * self.none)

    def texts(self) -> tuple[str, ...]:
        better = "less" if self.is_less_better else "more"
        numbers = (f"{value:.3f}" for value in (self.own, self.constant, self.none))
        return (self.where, f"{self.what}, {better} is better", *numbers)


def worth(law: Law, reported: Reported) -> str:
    cells = [
        *on_building(law.row, reported),
        *on_car(law.row, reported),
        *on_cantilever(law.row, reported),
    ]
    if not cells:
        return (
            "Not tuned on a structure, so that nothing is claimed of it beside no current and the "
            "best\nconstant current. What it does: "
            "[published-laws.md](../../explanation/published-laws.md)."
        )
    head = ("structure", "figure", "tuned", "best constant current", "no current")
    return f"{verdict(cells)}\n\n{rows(head, [cell.texts() for cell in cells])}"


def verdict(cells: list[Cell]) -> str:
    won = [f"- {cell.where}: {cell.what}" for cell in cells if cell.is_won]
    if won:
        return "Tuned, it beats both no current and the best constant current:\n\n" + "\n".join(won)
    return "Tuned, it beats both no current and the best constant current on **none** of these."


def own_rows(name: str, laws: dict[str, Any]) -> list[Any]:
    """With each of its trackers: `NAME` and `NAME, TRACKER`."""
    return [law for key, law in laws.items() if name and key.partition(",")[0] == name]


def on_building(name: str, reported: Reported) -> list[Cell]:
    own = own_rows(name, reported.get("unseen", {}).get("laws", {}))
    if not own:
        return []
    one = min(own, key=lambda law: law["index_tuned"])
    figures = (one["index_tuned"], one["index_best_constant"], one["index_passive_off"])
    return [Cell(BUILDING, "index", *figures)]


def on_car(name: str, reported: Reported) -> list[Cell]:
    own = own_rows(name, reported.get("unseen_road", {}).get("laws", {}))
    cells = []
    for aim, what in (("comfort", "comfort in m/s2"), ("tyre", "the tyre's load")) if own else ():
        one = min((law[aim] for law in own), key=lambda law: law["tuned"])
        cells.append(Cell(CAR, what, one["tuned"], one["best_constant"], one["passive_off"]))
    return cells


def on_cantilever(name: str, reported: Reported) -> list[Cell]:
    found = reported.get("cantilever", {}).get("rows", {})
    own = [row["score_pct"] for key, row in found.items() if is_of(name, key)]
    constant = [row["score_pct"] for key, row in found.items() if key.startswith(BEST_CONSTANT)]
    if not own or not constant:
        return []
    what = "mean reduction of displacement and acceleration in %"
    return [Cell(CANTILEVER, what, max(own), max(constant), 0.0, is_less_better=False)]


def is_of(name: str, row: str) -> bool:
    """`NAME`; of self-tuning its variants, too."""
    return bool(name) and (row == name or (name == "fuzzy_selftune" and row.startswith(name)))


def index_table(laws: list[Law]) -> str:
    body = [(f"[{law.name}.md](reference/laws/{law.name}.md)", law.summary) for law in laws]
    return rows(("page", "what"), body)


def written(root: Path) -> dict[Path, str]:
    """What every file should hold."""
    results = root / RESULTS
    data = json.loads(results.read_text()) if results.exists() else {}
    reported: Reported = data.get("context", {}).get("reported", {})
    others = tomllib.loads((root / OTHERS).read_text())["law"]
    laws = [*(of_recipe(recipe, reported) for recipe in RECIPES), *map(of_table, others)]
    files = {FOLDER / f"{law.name}.md": page(law, reported) for law in laws}
    index = (root / INDEX).read_text()
    files[INDEX] = LISTED.sub(lambda match: match[1] + index_table(laws) + match[2], index)
    return files


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--check", action="store_true", help="compare only, exit 1 on a difference")
    is_check = parser.parse_args().check
    files = written(ROOT)
    there = {FOLDER / file.name for file in (ROOT / FOLDER).glob("*.md")}
    wrong = [file for file, text in files.items() if not is_same(ROOT / file, text)]
    wrong += sorted(there - set(files))
    for file in wrong:
        if is_check:
            print(f"{file} differs from what {Path(__file__).name} writes", file=sys.stderr)
        elif file in files:
            (ROOT / file).parent.mkdir(exist_ok=True)
            (ROOT / file).write_text(files[file])
        else:
            (ROOT / file).unlink()
    return 1 if is_check and wrong else 0


def is_same(file: Path, text: str) -> bool:
    return file.exists() and file.read_text() == text


if __name__ == "__main__":
    sys.exit(main())
