"""Updates over CAN beside a real controller: the firmware's node with its places for images, whose
flash is a file, SLCAN on a pty."""

import json
import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest
from can_bus import Controller, build_peer
from conftest import ROOT, Result, require
from quiesce.can.buses import Bus
from quiesce.can.database import load
from quiesce.can.images import PIECE_WORDS, Images, crc_of_board, pieces_of
from quiesce.can.link import Link
from quiesce.cli.main import main
from quiesce.firmware.container import make_keys, payload_of, sign
from quiesce.firmware.image import (
    BOOT_BYTES,
    FLASH_BEGIN,
    INFO_LAYOUT,
    INFO_MAGIC,
    SLOT_BEGINS,
    SLOT_BYTES,
    SLOT_MARK_BYTES,
    UNSEALED,
    image_of,
    sealed,
)
from quiesce.firmware.making import Made
from quiesce.firmware.release import UPDATABLE, update_ending, write_release, write_sums
from quiesce.table.words import packed, unpacked

BOARD = "olimex_h405"
FLASH_BYTES = 512 << 10


@pytest.fixture(scope="session")
def peer(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return build_peer(tmp_path_factory.mktemp("can_peer"))


def small_image(slot: int, version: str, board: str = BOARD) -> bytes:
    """As hal/image/image_info.h has it, with nothing to run: a real one takes half a minute."""
    begin, seal_at = SLOT_BEGINS[slot], 9000
    major, minor, patch = map(int, version.split("."))
    content = bytearray(i * 37 % 251 for i in range(seal_at)) + UNSEALED
    number = major << 16 | minor << 8 | patch
    info = (INFO_MAGIC, INFO_LAYOUT, number, 9, begin, begin + seal_at, begin + 600, begin + 700)
    content[452:484] = packed(info)
    content[600:604] = packed([begin + 620])
    content[620 : 621 + len(board)] = board.encode() + b"\0"
    content[700:704] = packed([0])
    return sealed(bytes(content))


def small_release(folder: Path, version: str, key: Path) -> Path:
    folder.mkdir()
    name = f"quiesce_{BOARD}-{version}"
    images = [small_image(slot, version) for slot in (0, 1)]
    for slot, image in enumerate(images):
        sign(image, version, key, folder / f"{name}{update_ending(slot)}")
    flash = b"\xff" * BOOT_BYTES + images[0].ljust(SLOT_BYTES, b"\xff")
    (folder / f"{name}{UPDATABLE}").write_bytes(flash)
    write_sums(folder)
    return folder


@pytest.fixture(scope="session")
def keys(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("keys")
    make_keys(folder / "maker.pem", folder / "public.pem")
    return folder


@pytest.fixture
def release(tmp_path: Path, keys: Path) -> Path:
    return small_release(tmp_path / "release", "0.1.0", keys / "maker.pem")


@pytest.fixture
def newer(tmp_path: Path, keys: Path) -> Path:
    return small_release(tmp_path / "newer", "0.2.0", keys / "maker.pem")


class Rig:
    """A board that was flashed with boot code and image, and the tools on its bus."""

    def __init__(self, exe: Path, release: Path, folder: Path, capsys) -> None:
        self.controller = Controller(exe, folder)
        self.flash = folder / "flash.bin"
        (updatable,) = release.glob("*.updatable.bin")
        self.flash.write_bytes(updatable.read_bytes().ljust(FLASH_BYTES, b"\xff"))
        self._capsys = capsys

    def start(self, *options: str) -> None:
        self.controller.start("--idle", "--images", str(self.flash), "--board", BOARD, *options)

    def restart(self, *options: str) -> None:
        """As if the power had gone and come."""
        self.controller.stop()
        self.start(*options)

    def tool(self, *words: str | Path) -> Result:
        code = main(["can", *map(str, words), "--bus", self.controller.bus])
        return Result(words, code, *self._capsys.readouterr())

    def update(self, *words: str | Path) -> Result:
        return self.tool("update", *words)

    def runs(self, folder: Path) -> str:
        """The version that runs."""
        result = self.update(folder, "--dry-run", "--json", "--at-least", "0.0.1")
        assert result.returncode == 0, result.stderr
        return str(json.loads(result.stdout)["from"])


@pytest.fixture
def rig(peer: Path, release: Path, tmp_path: Path, capsys) -> Iterator[Rig]:
    one = Rig(peer, release, tmp_path, capsys)
    one.start()
    yield one
    one.controller.stop()


def test_an_update_runs_is_confirmed_and_stays(rig: Rig, newer: Path, keys: Path) -> None:
    result = rig.update(newer, "--key", keys / "public.pem")
    assert result.returncode == 0, result.stderr
    assert f"runs    {BOARD} 0.1.0 -> 0.2.0" in result.stdout and "confirmed" in result.stdout
    assert "% " not in result.stdout and "100 %" in result.stderr
    assert rig.runs(newer) == "0.2.0"
    rig.restart()
    assert rig.runs(newer) == "0.2.0"


def test_the_next_update_goes_back_into_the_first_place(
    rig: Rig, newer: Path, keys: Path, tmp_path: Path
) -> None:
    assert rig.update(newer).returncode == 0
    newest = small_release(tmp_path / "newest", "0.3.0", keys / "maker.pem")
    result = rig.update(newest, "--json")
    assert result.returncode == 0, result.stderr
    report = json.loads(result.stdout)
    assert (report["from"], report["to"], report["place"]) == ("0.2.0", "0.3.0", 0)
    assert report["is_updated"]


def test_an_image_that_fails_is_gone_back_from(rig: Rig, newer: Path) -> None:
    rig.restart("--bad", str(0x000200))
    result = rig.update(newer)
    assert result.returncode == 1
    assert "did not start, or failed; the one before runs again" in result.stderr
    assert rig.runs(newer) == "0.1.0"
    rig.restart()
    assert rig.runs(newer) == "0.1.0"  # it is not tried again
    assert rig.update(newer).returncode == 0  # but may be brought again


def test_what_is_cut_off_leaves_what_runs(rig: Rig, newer: Path) -> None:
    class Cut(Exception):
        pass

    def cut(done: int, total: int) -> None:
        if done > total // 2:
            raise Cut

    (file,) = newer.glob("*.slot1.update")
    with Link(Bus("slcan", str(rig.controller.path), None, ())) as link, pytest.raises(Cut):
        Images(link, load()).install(payload_of(file.read_bytes()), cut)
    rig.restart()
    assert rig.runs(newer) == "0.1.0"
    assert rig.update(newer).returncode == 0


def test_an_older_one_is_brought_where_that_is_allowed(
    rig: Rig, release: Path, newer: Path
) -> None:
    assert rig.update(newer).returncode == 0
    back = rig.update(release, "--at-least", "0.1.0", "--json")
    assert back.returncode == 0, back.stderr
    assert rig.runs(newer) == "0.1.0"


def test_the_image_that_runs_is_not_brought_again(rig: Rig, release: Path) -> None:
    before = rig.flash.read_bytes()
    result = rig.update(release)
    assert result.returncode == 0, result.stderr
    assert "0.1.0 already; nothing was changed" in result.stdout
    assert rig.flash.read_bytes() == before


@pytest.mark.parametrize(
    ("words", "why"),
    [
        ((), "is older than 0.2.0; --at-least allows it"),
        (("--key", "other.pem"), "not signed by this key"),
        (("--at-least", "9.9.9"), "is older than 9.9.9"),
        (("--at-least", "new"), "no version"),
    ],
)
def test_what_may_not_be_brought_is_refused_before_anything_is_sent(
    rig: Rig, release: Path, newer: Path, tmp_path: Path, words: tuple[str, ...], why: str
) -> None:
    make_keys(tmp_path / "other_private.pem", tmp_path / "other.pem")
    if not words:
        assert rig.update(newer).returncode == 0
    before = rig.flash.read_bytes()
    words = tuple(str(tmp_path / word) if word.endswith(".pem") else word for word in words)
    result = rig.update(release, *words)
    assert (result.returncode, result.stdout) == (2, "")
    assert why in result.stderr and len(result.stderr.splitlines()) == 1
    assert rig.flash.read_bytes() == before


def test_folders_that_are_none_are_refused(rig: Rig, newer: Path, tmp_path: Path) -> None:
    (tmp_path / "empty").mkdir()
    damaged = shutil.copytree(newer, tmp_path / "damaged")
    (file,) = damaged.glob("*.slot1.update")
    data = bytearray(file.read_bytes())
    data[5000] ^= 1
    file.write_bytes(data)
    swapped = shutil.copytree(newer, tmp_path / "swapped")
    files = sorted(swapped.glob("*.update"))
    files[1].write_bytes(files[0].read_bytes())
    write_sums(swapped)
    for folder, why in (
        (tmp_path / "none", "no folder of"),
        (tmp_path / "empty", "SHA256SUMS is missing"),
        (damaged, "is not the file of SHA256SUMS"),
        (swapped, "linked for 0x08004000"),
    ):
        result = rig.update(folder)
        assert (result.returncode, result.stdout) == (2, ""), folder
        assert why in result.stderr and len(result.stderr.splitlines()) == 1, result.stderr


def test_it_is_refused_while_armed(rig: Rig, newer: Path) -> None:
    assert rig.tool("get", "law").returncode == 0  # it runs, and takes signals
    rig.controller.turn_enable()
    assert rig.tool("get", "law").returncode == 0
    result = rig.update(newer)
    assert result.returncode == 1
    assert "the controller is armed; disable it first" in result.stderr
    rig.controller.turn_enable()


def test_another_board_is_refused(peer: Path, release: Path, tmp_path: Path, capsys) -> None:
    rig = Rig(peer, release, tmp_path, capsys)
    other = small_image(0, "0.1.0", "olimex_h406")
    rig.flash.write_bytes((b"\xff" * BOOT_BYTES + other).ljust(FLASH_BYTES, b"\xff"))
    rig.controller.start("--idle", "--images", str(rig.flash), "--board", "olimex_h406")
    result = rig.update(release)
    rig.controller.stop()
    assert result.returncode == 2
    assert "for olimex_h405, which the controller is not" in result.stderr


def test_a_controller_without_places_says_so(
    peer: Path, release: Path, tmp_path: Path, capsys
) -> None:
    rig = Rig(peer, release, tmp_path, capsys)
    rig.controller.start("--idle")
    result = rig.update(release)
    rig.controller.stop()
    assert result.returncode == 1
    assert "no second place for an image: flash NAME.updatable.bin once" in result.stderr


def test_frames_that_are_lost_cost_time_and_nothing_else(
    peer: Path, release: Path, newer: Path, tmp_path: Path, capsys
) -> None:
    rig = Rig(peer, release, tmp_path, capsys)
    rig.start("--drop", "997")
    result = rig.update(newer)
    assert result.returncode == 0, result.stderr
    rig.controller.stop()


def test_pieces_are_whole_tables_and_make_up_the_image() -> None:
    payload = bytes(range(256)) * 33 + b"abc"
    words: list[int] = []
    for data, crc in pieces_of(payload):
        piece = unpacked(data)[4:]
        assert piece[:4] == [0x31504951, crc, len(piece), len(words)]
        assert len(piece) - 4 <= PIECE_WORDS
        words += piece[4:]
    made = b"".join(word.to_bytes(4, "little") for word in words)
    assert made == payload + b"\xff"


def test_a_board_s_name_is_told_by_its_crc() -> None:
    """As tests/unit/stm32f4/test_images.c has it."""
    text = (ROOT / "tests/unit/stm32f4/test_images.c").read_text()
    assert f"0x{crc_of_board('some_board'):08X}" in text


@pytest.fixture(scope="session")
def built(tmp_path_factory: pytest.TempPathFactory, keys: Path) -> Path:
    """What `quiesce firmware build` writes, of what is compiled here."""
    folder = tmp_path_factory.mktemp("built")
    elf = require(ROOT / f"build/stm32f4/targets/stm32f4/quiesce_stm32f4_{BOARD}.elf")
    write_release(Made.of(elf), keys / "maker.pem", "12.2.1", folder)
    return folder


def test_first_place_comes_with_the_boot_code(built: Path) -> None:
    (file,) = built.glob(f"*{UPDATABLE}")
    data = file.read_bytes()
    assert len(data) == BOOT_BYTES + SLOT_BYTES
    assert image_of(data, file).is_whole and image_of(data, file).begin == SLOT_BEGINS[0]
    assert data[-SLOT_MARK_BYTES:] == b"\xff" * SLOT_MARK_BYTES  # as good as confirmed


@pytest.mark.slow
def test_an_image_as_it_is_built_is_brought(
    peer: Path, built: Path, tmp_path: Path, capsys
) -> None:
    rig = Rig(peer, built, tmp_path, capsys)
    flash = bytearray(rig.flash.read_bytes())
    flash[BOOT_BYTES : BOOT_BYTES + SLOT_BYTES] = small_image(0, "0.0.9").ljust(SLOT_BYTES, b"\xff")
    rig.flash.write_bytes(flash)
    rig.start()
    result = rig.update(built)
    rig.controller.stop()
    assert result.returncode == 0, result.stderr
    assert "0.0.9 -> 0.1.0" in result.stdout
    (file,) = built.glob("*.slot1.update")
    payload = payload_of(file.read_bytes())
    begin = SLOT_BEGINS[1] - FLASH_BEGIN
    assert rig.flash.read_bytes()[begin : begin + len(payload)] == payload
