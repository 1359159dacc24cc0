"""Where a line lives and who may import whom, read from the sources (rooms.toml has the rules)."""

from pathlib import Path

from house import c_rules, python_rules
from house.c_sources import Tree, room_of
from house.circles import circles_of, merged
from house.python_sources import Package, room_of_module
from house.rooms import unknown_rooms


def c_circles(tree: Tree) -> list[list[str]]:
    return circles_of(merged(tree.includes, room_of)) + circles_of(tree.leans_on)


def python_circles(package: Package) -> list[list[str]]:
    return circles_of(merged(package.imports, room_of_module)) + circles_of(package.imports)


def import_circles(root: Path) -> list[list[str]]:
    """Circles of imports between rooms, between files of C and C++, between modules of Python."""
    return c_circles(Tree(root)) + python_circles(Package(root))


def c_violations(tree: Tree) -> list[str]:
    found = [line for check in c_rules.CHECKS for line in check(tree)]
    return found + [f"circle of includes: {', '.join(circle)}" for circle in c_circles(tree)]


def python_violations(package: Package) -> list[str]:
    found = [line for check in python_rules.CHECKS for line in check(package)]
    return found + [f"circle of imports: {', '.join(circle)}" for circle in python_circles(package)]


def violations(root: Path) -> list[str]:
    return [*unknown_rooms(root), *c_violations(Tree(root)), *python_violations(Package(root))]
