"""A copy of the scripts in tools/ that sees only the commands that a test puts on its PATH."""

import shutil
import subprocess
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
SCRIPTS = ("benchmarks/build_images", "benchmarks/fetch_peers", "hil", "quiesce", "setup", "test")
COMMON = (
    "awk bash cat chmod cp cut dirname env flock grep ln mkdir mktemp mv nproc readlink rm "
    "sha256sum tail tar touch"
).split()
ALL_INSTALLED = 'shift 2; for p in "$@"; do echo "installed $p"; done'


class Clone:
    """A copy of the scripts and the commands that they can see."""

    def __init__(self, folder: Path) -> None:
        self.root = folder / "a clone"
        self.bin = folder / "bin"
        self.bin.mkdir()
        shutil.copytree(ROOT / "tools/lib", self.root / "tools/lib")
        shutil.copytree(ROOT / "tools/benchmarks/lib", self.root / "tools/benchmarks/lib")
        for name in (*SCRIPTS, "packages.txt", "requirements.txt"):
            shutil.copy(ROOT / "tools" / name, self.root / "tools" / name)
        for name in COMMON:
            (self.bin / name).symlink_to(shutil.which(name))
        self.fake("id", "echo 1000")
        self.fake("sleep", "exit 0")
        self.fake("dpkg-query", ALL_INSTALLED)

    def fake(self, name: str, script: str) -> Path:
        """A command that notes its arguments in NAME.calls and then does what `script` says."""
        path = self.bin / name
        calls = self.bin / f"{name}.calls"
        path.write_text(f'#!/bin/bash\necho "$*" >>"{calls}"\n{script}\n')
        path.chmod(0o755)
        return path

    def calls(self, name: str) -> list[str]:
        path = self.bin / f"{name}.calls"
        return path.read_text().splitlines() if path.exists() else []

    def run(self, *command: str, **env: str) -> subprocess.CompletedProcess[str]:
        return subprocess.run(
            command,
            cwd=self.root,
            env={"PATH": str(self.bin), **env},
            stdin=subprocess.DEVNULL,
            capture_output=True,
            text=True,
            timeout=300,
        )

    def script(self, name: str, *arguments: str, **env: str) -> subprocess.CompletedProcess[str]:
        return self.run(str(self.root / "tools" / name), *arguments, **env)

    def function(self, libraries: str, code: str, **env: str) -> subprocess.CompletedProcess[str]:
        """Runs `code` with some of tools/lib and its like sourced."""
        folders = ("tools/lib", "tools/benchmarks/lib", "tests/system/vm")
        sources = "; ".join(
            f"source {folder}/{name}.sh"
            for name in libraries.split()
            for folder in folders
            if (ROOT / folder / f"{name}.sh").exists()
        )
        return self.run("bash", "-c", f"PROGRAM=here; {sources}; {code}", **env)
