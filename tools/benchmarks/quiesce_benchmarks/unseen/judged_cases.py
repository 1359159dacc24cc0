"""Cases that were judged, kept between runs: all of them take hours, and each is judged once."""

import hashlib
import json
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path
from typing import Any

import quiesce.damper
from quiesce.base.atomic import output_files
from quiesce.base.paths import build_folder

# Whose numbers the fits depend on.
PACKAGES = ("numpy", "scipy")


@dataclass(frozen=True)
class JudgedCases:
    """A file a case, in the folder of what it was judged with: another identification, other data
    or another plan has another folder."""

    folder: Path

    @classmethod
    def of(cls, data: Path, plan: dict[str, Any]) -> "JudgedCases":
        return cls(build_folder() / "unseen_cases" / key_of(data, plan))

    def get(self, name: str) -> dict[str, Any] | None:
        """What was put; None: nothing whole is there."""
        try:
            found = json.loads(self._file(name).read_text(encoding="utf-8"))
        except (OSError, ValueError):
            return None
        return found if isinstance(found, dict) and found.pop("name", None) == name else None

    def put(self, name: str, judged: dict[str, Any]) -> None:
        with output_files(self.folder) as staging:
            file = staging / self._file(name).name
            file.write_text(json.dumps({"name": name, **judged}, indent=1), encoding="utf-8")

    def _file(self, name: str) -> Path:
        return self.folder / f"{hashlib.sha256(name.encode()).hexdigest()[:16]}.json"


def key_of(data: Path, plan: dict[str, Any]) -> str:
    """Of the identification's sources, the measurements, the plan and the packages."""
    whole = hashlib.sha256(json.dumps(plan, sort_keys=True).encode())
    whole.update(" ".join(version(one) for one in PACKAGES).encode())
    package = Path(quiesce.damper.__path__[0])
    for folder, pattern in ((package, "*.py"), (data, "*.*")):
        for file in sorted(one for one in folder.rglob(pattern) if one.is_file()):
            whole.update(str(file.relative_to(folder)).encode() + b"\0")
            whole.update(hashlib.sha256(file.read_bytes()).digest())
    return whole.hexdigest()[:16]
