"""`quiesce law list`: the recipes that there are, and what one takes."""

import argparse
import json
from textwrap import fill

from quiesce.base.table import format_table
from quiesce.cli.terminal import show
from quiesce.law.recipe import Recipe
from quiesce.law.recipes import RECIPES, find

EPILOG = """examples:
  quiesce law list                     one line a recipe
  quiesce law list clipped_optimal     law, source, settings
"""


def add_parser(actions: argparse._SubParsersAction) -> None:
    parser = actions.add_parser(
        "list",
        help="published laws that `make` knows",
        description="List the published laws that `quiesce law make` makes tables of.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("recipe", nargs="?", help="one of them: its source and settings")
    parser.add_argument("--json", action="store_true", help="print one JSON object")
    parser.set_defaults(run=run)


def described(recipe: Recipe) -> str:
    rows = [
        (one.name, one.default, f"{one.low:g} .. {one.high:g}", one.help) for one in recipe.settings
    ]
    table = format_table(["setting", "default||g", "range", ""], rows, (0, 3))
    tracker = f"{recipe.tracker} or another" if recipe.tracker else ""
    facts = {
        "law": recipe.equation,
        "source": recipe.source,
        "errata": recipe.errata,
        "when": recipe.when,
        "tracker": tracker,
    }
    lines = [f"{recipe.name}: {recipe.summary}"]
    lines += [
        fill(text, initial_indent=f"{key:10s}", subsequent_indent=" " * 10, width=100)
        for key, text in facts.items()
        if text
    ]
    return "\n".join([*lines, "", table])


def as_data(recipe: Recipe) -> dict:
    return {
        "summary": recipe.summary,
        "equation": recipe.equation,
        "source": recipe.source,
        "errata": recipe.errata or None,
        "when": recipe.when,
        "tracker": recipe.tracker or None,
        "settings": {
            one.name: {"default": one.default, "low": one.low, "high": one.high}
            for one in recipe.settings
        },
    }


def run(args: argparse.Namespace) -> int:
    chosen = RECIPES if args.recipe is None else (find(args.recipe),)
    if args.json:
        print(json.dumps({recipe.name: as_data(recipe) for recipe in chosen}, indent=2))
    elif args.recipe is not None:
        show(described(chosen[0]))
    else:
        rows = [[one.name, "force" if one.tracker else "current", one.summary] for one in chosen]
        show(format_table(["recipe", "demands", ""], rows, (0, 1, 2)))
    return 0
