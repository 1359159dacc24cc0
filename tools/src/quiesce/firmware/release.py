"""The folder that `quiesce firmware build` writes: one image in every form, what it is made of,
what it takes, sums of all files.

    NAME.elf NAME.hex NAME.bin     sealed; NAME is quiesce_BOARD-VERSION
    NAME.signed.bin                in the container of MCUboot's imgtool
    NAME.updatable.bin             boot code and the image in its first place
    NAME.updatable.signed          the same in the container
    NAME.slot0.update, slot1       signed likewise, for each of the two places
    NAME.map sizes.txt             where everything is; what is how large
    sbom.cdx.json                  parts, as CycloneDX 1.6
    FLASH.md SHA256SUMS            how it gets onto the board; sums
"""

import hashlib
from io import BytesIO
from pathlib import Path

from quiesce.base.errors import UsageError
from quiesce.base.extras import extra
from quiesce.base.paths import root, shown
from quiesce.firmware.container import check, payload_of, sign, version_of
from quiesce.firmware.flashing import flash_page
from quiesce.firmware.image import (
    BOOT_BYTES,
    SLOT_BYTES,
    Image,
    image_of,
    loaded,
    read_bytes,
    read_image,
    sealed,
)
from quiesce.firmware.making import Made
from quiesce.firmware.parts_list import parts_list
from quiesce.firmware.sizes import sizes_of

SIGNED = ".signed.bin"
UPDATABLE = ".updatable.bin"
UPDATABLE_SIGNED = ".updatable.signed"
ERASED = b"\xff"
SUMS = "SHA256SUMS"


def write_release(made: Made, key: Path | None, compiler: str, folder: Path) -> Image:
    """made: as compiled; folder: there, and empty. The sealed image."""
    elf = made.whole
    payload = sealed(read_image(elf).payload)
    image = image_of(payload, elf)
    name = f"quiesce_{image.board}-{image.version_text}"
    (folder / f"{name}.bin").write_bytes(payload)
    (folder / f"{name}.elf").write_bytes(sealed_elf(read_bytes(elf), payload))
    write_hex(image.begin, payload, folder / f"{name}.hex")
    sign(payload, image.version_text, key, folder / f"{name}{SIGNED}")
    write_updates(made, image.version_text, key, folder / name)
    places = read_bytes(elf.with_name(elf.name + ".map"))
    (folder / f"{name}.map").write_bytes(without_place(places))
    sizes = sizes_of(elf).text()
    (folder / "sizes.txt").write_text(sizes + "\n", encoding="utf-8")
    digest = hashlib.sha256(payload).hexdigest()
    parts = parts_list(image, compiler, digest)
    (folder / "sbom.cdx.json").write_text(parts, encoding="utf-8")
    (folder / "FLASH.md").write_text(flash_page(name, image), encoding="utf-8")
    write_sums(folder)
    return image


def write_updates(made: Made, version: str, key: Path | None, start: Path) -> None:
    """start: of the files' names."""
    payloads = [sealed(read_image(elf).payload) for elf in made.slots]
    for number, payload in enumerate(payloads):
        sign(payload, version, key, start.with_name(start.name + update_ending(number)))
    boot = loaded(read_bytes(made.boot))[1]
    first = boot.ljust(BOOT_BYTES, ERASED) + payloads[0].ljust(SLOT_BYTES, ERASED)
    start.with_name(start.name + UPDATABLE).write_bytes(first)
    sign(first, version, key, start.with_name(start.name + UPDATABLE_SIGNED))


def update_ending(slot: int) -> str:
    return f".slot{slot}.update"


def without_place(text: bytes) -> bytes:
    """Of the linker's map: files of the project without where that lies."""
    return text.replace(f"{root()}/".encode(), b"")


def sealed_elf(elf: bytes, payload: bytes) -> bytes:
    """The same file, with the seal in its place."""
    with extra("firmware", "an ELF file"):
        from elftools.elf.elffile import ELFFile
    section = ELFFile(BytesIO(elf)).get_section_by_name(".image_seal")
    if section is None:
        raise UsageError("the image has no place for its seal; link it with hal/image/image.ld")
    at, size = section["sh_offset"], section["sh_size"]
    return elf[:at] + payload[-size:] + elf[at + size :]


def write_hex(begin: int, payload: bytes, file: Path) -> None:
    with extra("firmware", "an Intel HEX file"):
        from intelhex import IntelHex
    made = IntelHex()
    made.puts(begin, payload)
    made.write_hex_file(str(file), eolstyle="CRLF")


def write_sums(folder: Path) -> None:
    lines = [
        f"{hashlib.sha256(file.read_bytes()).hexdigest()}  {file.name}\n"
        for file in sorted(folder.iterdir())
        if file.name != SUMS
    ]
    (folder / SUMS).write_text("".join(lines), encoding="utf-8")


# ---- verification -------------------------------------------------------------------------------


def signed_file(place: Path, ending: str = SIGNED) -> Path:
    """place: a signed image, or a folder with one. UsageError where there is none."""
    if not place.is_dir():
        return place
    found = sorted(place.glob(f"*{ending}"))
    if len(found) != 1:
        what = "no image" if not found else f"{len(found)} images"
        raise UsageError(f"{shown(place)}: {what} *{ending}; name the folder of one build")
    return found[0]


def refusal(
    place: Path,
    key: Path | None,
    board: str | None,
    least: tuple[int, int, int] | None,
    ending: str = SIGNED,
) -> str:
    """Why it must not be flashed, in one line; empty where nothing speaks against it. key: the
    maker's public one. least: the oldest version allowed. ending: of the file, in a folder."""
    if place.is_dir() and (wrong := wrong_sum(place)):
        return wrong
    file = signed_file(place, ending)
    data = read_bytes(file)
    if wrong := check(file, key):
        return f"{file.name}: {wrong}"
    try:
        image = image_of(payload_of(data), file)
    except (UsageError, ValueError) as error:
        return str(error)
    return wrong_image(image, version_of(data), board, least)


def wrong_image(
    image: Image,
    said: tuple[int, int, int],
    board: str | None,
    least: tuple[int, int, int] | None,
) -> str:
    """said: the container's version."""
    if not image.is_whole:
        return "the image's seal is not that of its contents" if image.is_sealed else "not sealed"
    if said != image.version:
        told = ".".join(map(str, said))
        return f"the container says version {told}, the image {image.version_text}"
    if board is not None and board != image.board:
        return f"it is for {image.board}, not for {board}"
    if least is not None and image.version < least:
        return f"version {image.version_text} is older than {'.'.join(map(str, least))}"
    return ""


def wrong_sum(folder: Path) -> str:
    """Of SHA256SUMS: the first file that is another one, missing, or not listed."""
    try:
        text = (folder / SUMS).read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError):
        return f"{SUMS} is missing, or cannot be read"
    listed = dict(reversed(line.split("  ", 1)) for line in text.splitlines() if "  " in line)
    for file in sorted(folder.iterdir()):
        if file.name not in listed and file.name != SUMS:
            return f"{file.name} is not in {SUMS}"
    for name, wanted in listed.items():
        file = folder / name
        if "/" in name or not file.is_file():
            return f"{name} is missing"
        if hashlib.sha256(read_bytes(file)).hexdigest() != wanted:
            return f"{name} is not the file of {SUMS}"
    return ""
