#!/usr/bin/env python3
"""Write the tables of docs/develop/where-a-line-lives.md from the table of rooms that the
architecture test holds. `--check` writes nothing and exits 1 where the page differs."""

import argparse
import os
import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests/python/gates"))

from house.rooms import table  # noqa: E402

PAGE = ROOT / "docs/develop/where-a-line-lives.md"
MARKED = re.compile(r"(<!-- rooms: (\w+) -->\n).*?(<!-- end -->)", re.DOTALL)


def code(words: list[str], empty: str) -> str:
    return ", ".join("all" if word == "*" else f"`{word}`" for word in words) or empty


def rows(head: tuple[str, ...], lines: list[tuple[str, ...]]) -> str:
    rule = ("---",) * len(head)
    return "".join(f"| {' | '.join(line)} |\n" for line in (head, rule, *lines))


def in_one(folders: list[str]) -> str:
    """`firmware/{base,sense}`"""
    parent = os.path.commonpath([os.path.dirname(folder) for folder in folders])
    names = [os.path.relpath(folder, parent) for folder in folders]
    return f"`{parent}/{names[0]}/`" if len(names) == 1 else f"`{parent}/{{{','.join(names)}}}/`"


def questions() -> str:
    lines = [
        (str(number), one["asks"], in_one(one["folders"]), one["then"])
        for number, one in enumerate(table()["questions"], 1)
    ]
    return rows(("", "ask", "yes: it lives in", "as"), lines)


def includes() -> str:
    lines = [(f"`{room}`", code(seen, "nothing")) for room, seen in table()["c"].items()]
    return rows(("files of", "may include headers of"), lines)


def imports() -> str:
    lines = [(f"`{room}`", code(seen, "nothing")) for room, seen in table()["python"].items()]
    return rows(("modules of", "may import"), lines)


def speakers() -> str:
    lines = [(f"`{name}`", reason) for name, reason in table()["speaks"].items()]
    return rows(("module", "why"), lines)


TABLES = {"questions": questions, "c": includes, "python": imports, "speaks": speakers}


def filled(page: str) -> str:
    return MARKED.sub(lambda part: part[1] + TABLES[part[2]]() + part[3], page)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--check", action="store_true", help="compare only, exit 1 on a difference")
    is_check = parser.parse_args().check
    now = PAGE.read_text()
    page = filled(now)
    if page == now:
        return 0
    if is_check:
        print(f"{PAGE.relative_to(ROOT)} differs: run tests/gen/rooms.py", file=sys.stderr)
        return 1
    PAGE.write_text(page)
    return 0


if __name__ == "__main__":
    sys.exit(main())
