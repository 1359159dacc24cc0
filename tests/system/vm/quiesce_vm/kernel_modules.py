"""Which kernel modules to load, in which order. Each module names its own dependencies."""

from pathlib import Path

from quiesce.base.errors import UsageError


def load_order(folder: Path, wanted: list[str]) -> list[Path]:
    """Files of `wanted` and of all that they need, dependencies first.

    folder: of a kernel's modules (*.ko). Built-in dependencies are named by no module. UsageError
    where a module is missing.
    """
    files = {_name(file.stem): file for file in folder.rglob("*.ko")}
    order: list[Path] = []

    def visit(name: str, asked_by: str) -> None:
        file = files.get(_name(name))
        if file is None:
            raise UsageError(
                f"kernel module {name} ({asked_by}) is not in {folder}; "
                "remove build/vm/kernel and run tests/system/vm/build_images again"
            )
        if file not in order:
            for dependency in dependencies(file.read_bytes()):
                visit(dependency, f"needed by {name}")
            order.append(file)

    for name in wanted:
        visit(name, "wanted")
    return order


def dependencies(module: bytes) -> list[str]:
    """What a module's section .modinfo says after "depends="."""
    start = module.find(b"\0depends=")
    if start < 0:
        return []
    start += len(b"\0depends=")
    names = module[start : module.index(b"\0", start)].decode()
    return [name for name in names.split(",") if name]


def _name(stem: str) -> str:
    return stem.replace("-", "_")
