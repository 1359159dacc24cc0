"""Rule files by their extension: read with every fault placed, written without silent loss."""

from pathlib import Path

from quiesce.base.errors import UsageError
from quiesce.base.paths import shown
from quiesce.rules.formats.build import Builder, Options
from quiesce.rules.formats.fcl import read_fcl
from quiesce.rules.formats.fis import read_fis
from quiesce.rules.formats.fll import read_fll
from quiesce.rules.formats.same import difference
from quiesce.rules.formats.same_system import system_difference
from quiesce.rules.formats.scan import Source, Token
from quiesce.rules.formats.t2fis import read_t2fis
from quiesce.rules.formats.write_fcl import fcl_text
from quiesce.rules.formats.write_fis import fis_text
from quiesce.rules.formats.write_fll import fll_text
from quiesce.rules.formats.write_system_fcl import fcl_system_text
from quiesce.rules.formats.write_system_fis import fis_system_text
from quiesce.rules.formats.write_system_fll import fll_system_text
from quiesce.rules.model import RuleBase
from quiesce.rules.system.model import System

READERS = {"fcl": read_fcl, "fll": read_fll, "fis": read_fis, "t2fis": read_t2fis}
WRITERS = {"fcl": fcl_text, "fll": fll_text, "fis": fis_text}
SYSTEM_WRITERS = {"fcl": fcl_system_text, "fll": fll_system_text, "fis": fis_system_text}
FORMATS = tuple(WRITERS)  # that are read and written
MAX_BYTES = 1 << 20
MAX_SEGMENTS = 128  # of a chain; at least 2


def read_rules(path: Path, approximate: int | None = None, first_order: bool = False) -> RuleBase:
    """approximate, first_order: see read_text. UsageError, `FILE:LINE:COLUMN: ...`, for what is no
    rule file."""
    format, name = format_of(path), shown(path)
    return read_text(load(path, name), format, path.stem, approximate, name, first_order)


def read_text(
    text: str,
    format: str,
    name: str,
    approximate: int | None = None,
    file: str | None = None,
    first_order: bool = False,
) -> RuleBase:
    """name: of the base where the text gives it none; file: what errors call the text.

    approximate: segments of the chain that stands for a smooth membership function, which is an
    error without. first_order: terms may be straight lines (Singleton.slopes), which is an error
    without.
    """
    if approximate is not None and not 2 <= approximate <= MAX_SEGMENTS:
        raise UsageError(f"--approximate {approximate}; 2 to {MAX_SEGMENTS} segments")
    builder, title, at = parsed(text, format, name, file, Options(approximate, first_order))
    return builder.plain(title, at)


def parsed(
    text: str, format: str, name: str, file: str | None, options: Options
) -> tuple[Builder, str, Token]:
    source = Source(file or f"{name}.{format}", text)
    if not text.strip():
        raise source.error(0, "the file is empty", "a rule base")
    return READERS[format](source, name, options)


def read_system(path: Path) -> System:
    """All that a rule file says. UsageError, `FILE:LINE:COLUMN: ...`, for what is no rule file, or
    more than a system can hold."""
    format, name = format_of(path), shown(path)
    builder, title, at = parsed(load(path, name), format, path.stem, name, Options())
    return builder.system(title, at)


def format_of(path: Path) -> str:
    format = path.suffix.lower().removeprefix(".")
    if format not in READERS:
        raise UsageError(f"{shown(path)}: not a rule file; its name ends in .{', .'.join(READERS)}")
    return format


def load(path: Path, name: str) -> str:
    try:
        with path.open("rb") as stream:
            content = stream.read(MAX_BYTES + 1)
    except OSError as error:
        raise UsageError(f"{name}: {error.strerror}; name a rule file")
    if len(content) > MAX_BYTES:
        raise UsageError(f"{name}:1:1: the file is larger than 1 MiB, expected a rule file")
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        before = Source(name, content[: error.start].decode("utf-8-sig").replace("\0", " "))
        raise before.error(len(before.text), "not UTF-8", "a text file")


def write_text(base: RuleBase, format: str) -> str:
    """The base in this format. UsageError where the format cannot hold it.

    What was written is read again and compared, so that nothing can be lost in silence.
    """
    text = WRITERS[format](base)
    try:
        again = read_text(text, format, base.name)
    except UsageError as error:
        raise UsageError(f"{base.name} cannot be written as {format.upper()}: {error}")
    different = difference(base, again)
    if different:
        raise UsageError(
            f"{base.name} cannot be written as {format.upper()}: what is lost: {different}"
        )
    return text


def write_system(system: System, format: str) -> str:
    """A system of any kind in this format. UsageError where that cannot hold it.

    What was written is read again, and must answer the same in float64.
    """
    text = SYSTEM_WRITERS[format](system)
    failed = f"{system.name} cannot be written as {format.upper()}"
    try:
        builder, title, at = parsed(text, format, system.name, None, Options())
        again = builder.system(title, at)
    except UsageError as error:
        raise UsageError(f"{failed}: {error}")
    different = system_difference(system, again)
    if different:
        raise UsageError(f"{failed}: what is lost: {different}")
    return text
