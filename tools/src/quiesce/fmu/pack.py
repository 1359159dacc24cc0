"""An FMU as a file: the description, the library, its resources."""

import shutil
import tempfile
import zipfile
from collections.abc import Sequence
from pathlib import Path

from quiesce.base.atomic import output_files
from quiesce.fmu import fmi2, fmi3
from quiesce.fmu.library import Description, describe, library_file
from quiesce.fmu.page import page_of
from quiesce.fmu.resources import write_resources
from quiesce.fmu.xml import Model

VERSIONS = {"2": fmi2, "3": fmi3}
SUFFIX = ".fmu"
EARLIEST = (1980, 1, 1, 0, 0, 0)  # that the format of archives knows: the same file each time


def pack(
    kind: str, words: Sequence[str], files: dict[str, Path], fmi: str, text: str, out: Path
) -> Description:
    """Writes the FMU `out`. words, files: arguments of the bench (resources.py).

    UsageError where the bench would refuse them.
    """
    with tempfile.TemporaryDirectory(prefix="quiesce-fmu-") as temporary:
        folder = Path(temporary)
        resources = folder / "resources"
        resources.mkdir()
        token = write_resources(resources, kind, words, files)
        model = Model(out.stem, f"quiesce_{kind}", token, text, describe(resources))
        version = VERSIONS[fmi]
        (folder / "modelDescription.xml").write_bytes(version.description(model))
        documentation = folder / "documentation"
        documentation.mkdir()
        (documentation / "index.html").write_text(page_of(model, kind), encoding="utf-8")
        binaries = folder / version.BINARIES
        binaries.mkdir(parents=True)
        shutil.copyfile(library_file(), binaries / f"{model.identifier}.so")
        with output_files(out.resolve().parent) as staging:
            archive(folder, staging / out.name)
    return model.description


def archive(folder: Path, out: Path) -> None:
    """Every file of a folder, in order."""
    with zipfile.ZipFile(out, "w", zipfile.ZIP_DEFLATED) as packed:
        for file in sorted(one for one in folder.rglob("*") if one.is_file()):
            info = zipfile.ZipInfo(file.relative_to(folder).as_posix(), EARLIEST)
            info.compress_type = zipfile.ZIP_DEFLATED
            info.external_attr = (0o755 if file.suffix == ".so" else 0o644) << 16
            packed.writestr(info, file.read_bytes())
