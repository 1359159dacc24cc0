"""What the tests of the Debian packages share. They build nothing: `./tools/test --only package`
does that first (tools/package, tools/package --root).

QUIESCE_BUILD names another folder with packages/ and package/.
"""

import os
import re
import subprocess
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[3]
BUILD = Path(os.environ.get("QUIESCE_BUILD", ROOT / "build")).resolve()
ARCHITECTURES = ("amd64", "arm64")

Result = subprocess.CompletedProcess[str]


def run(*command: str | Path, **options) -> Result:
    return subprocess.run(
        [str(part) for part in command],
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        timeout=600,
        **options,
    )


def succeed(*command: str | Path, **options) -> str:
    """Standard output of a command that must succeed."""
    result = run(*command, **options)
    assert result.returncode == 0, f"{command}: {result.stdout}{result.stderr}"
    return result.stdout


def as_root(*command: str | Path) -> str:
    return succeed(*([] if os.geteuid() == 0 else ["sudo", "-n"]), *command)


@dataclass(frozen=True)
class Package:
    """One package file."""

    arch: str
    path: Path

    def field(self, name: str) -> str:
        return succeed("dpkg-deb", "--field", self.path, name).strip()


@pytest.fixture(scope="session", params=ARCHITECTURES)
def package(request: pytest.FixtureRequest) -> Package:
    files = sorted(BUILD.glob(f"packages/quiesced_*_{request.param}.deb"))
    if len(files) != 1:
        pytest.fail(
            f"one package for {request.param} is needed in {BUILD}/packages, there are "
            f"{len(files)}; run ./tools/package (remove old ones)",
            pytrace=False,
        )
    return Package(request.param, files[0])


@pytest.fixture(scope="session")
def contents(package: Package, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The package's files, unpacked."""
    folder = tmp_path_factory.mktemp(package.arch)
    succeed("dpkg-deb", "--extract", package.path, folder)
    return folder


class CleanRoot:
    """A copy of a clean Debian 12, to change as root."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder

    def run(self, *command: str) -> Result:
        return run(ROOT / "tools/lib/in_root", self.folder, *command)

    def succeed(self, *command: str) -> str:
        return succeed(ROOT / "tools/lib/in_root", self.folder, *command)

    def copy_in(self, file: Path, name: str) -> str:
        """The file's path in there."""
        as_root("install", "-m", "644", file, self.folder / "tmp" / name)
        return f"/tmp/{name}"

    def dpkg(self, *arguments: str) -> str:
        return self.succeed("/usr/bin/dpkg", "--force-unsafe-io", *arguments)

    def files(self) -> set[str]:
        """Every path and, of files, the contents; without what dpkg itself and caches note."""
        listing = as_root(
            "sh",
            "-c",
            'cd "$1" && find . -path ./.emulator -prune -o -path ./tmp -prune '
            "-o -path ./var/log -prune -o -path ./var/lib/dpkg -prune "
            "-o ! -type f -print -o -exec md5sum {} +",
            "sh",
            self.folder,
        )
        return {line for line in listing.splitlines() if not re.search(r"ld\.so\.cache$", line)}


@pytest.fixture(scope="session")
def root_copy(package: Package, tmp_path_factory: pytest.TempPathFactory) -> Iterator[CleanRoot]:
    origin = BUILD / "package" / f"root-{package.arch}"
    if not (origin / ".configured").exists():
        pytest.fail(f"{origin} is not there; run ./tools/package --root", pytrace=False)
    folder = tmp_path_factory.mktemp("clean") / "root"
    as_root("cp", "-a", origin, folder)
    yield CleanRoot(folder)
    as_root("rm", "-rf", folder)


@pytest.fixture
def clean_root(root_copy: CleanRoot) -> Iterator[CleanRoot]:
    """Without the package, before and after: a test of its own sees that purging leaves nothing."""
    yield root_copy
    root_copy.dpkg("--purge", "quiesced")
