"""An image for a controller at work: the right one of a build, whether it may be brought there, and
how that goes."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from quiesce.base.errors import BenchFailure, UsageError
from quiesce.base.paths import shown
from quiesce.can.images import Images, Progress, Running, crc_of_board
from quiesce.firmware.container import payload_of
from quiesce.firmware.image import Image, image_of, read_bytes
from quiesce.firmware.release import refusal, signed_file, update_ending
from quiesce.table.words import unpacked

Version = tuple[int, int, int]


@dataclass(frozen=True)
class Wanted:
    """key: the maker's public one. least: the oldest version allowed; None: the one that runs."""

    folder: Path
    key: Path | None
    least: Version | None


def image_for(running: Running, wanted: Wanted) -> Image:
    """Verified, for the place that does not run. UsageError where it must not go there."""
    if not wanted.folder.is_dir():
        raise UsageError(f"{shown(wanted.folder)}: no folder of `quiesce firmware build`; name one")
    ending = update_ending(1 - running.slot)
    least = running.version if wanted.least is None else wanted.least
    if why := refusal(wanted.folder, wanted.key, None, least, ending):
        allows = "; --at-least allows it" if "is older than" in why else ""
        raise UsageError(f"{shown(wanted.folder)}: refused: {why}{allows}")
    image, file = image_in(wanted.folder, ending)
    if crc_of_board(image.board) != running.board:
        raise UsageError(f"{file.name}: for {image.board}, which the controller is not")
    if image.begin != running.begin:
        raise UsageError(
            f"{file.name}: linked for 0x{image.begin:08X}, the controller's other place is at "
            f"0x{running.begin:08X}"
        )
    if len(image.payload) > running.room:
        raise UsageError(
            f"{file.name}: {len(image.payload):,} bytes; there is room for {running.room:,}"
        )
    return image


def image_in(folder: Path, ending: str) -> tuple[Image, Path]:
    file = signed_file(folder, ending)
    return image_of(payload_of(read_bytes(file)), file), file


def runs_already(running: Running, folder: Path) -> bool:
    """What runs is the same build's image for its place."""
    return mark_of(image_in(folder, update_ending(running.slot))[0]) == running.mark


def mark_of(image: Image) -> int:
    """By which the controller tells that it runs."""
    return unpacked(image.seal)[0]


def update(
    images: Images, before: Running, image: Image, tell: Callable[[str], None], progress: Progress
) -> None:
    """BenchFailure where it does not come about: what ran before then runs again, or still."""
    if before.is_trial:
        raise BenchFailure("the image that runs is on trial; ask again once it is confirmed")
    tell(f"erasing place {1 - before.slot}")
    images.install(image.payload, progress)
    tell("whole; restarting on trial")
    images.restart()
    if not images.comes_back_as(mark_of(image), before.mark):
        raise BenchFailure("the new image did not start, or failed; the one before runs again")
