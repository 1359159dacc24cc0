"""Images of boards as files: written, read, verified; what must not be flashed is refused."""

import json
import shutil
import struct
from pathlib import Path
from types import SimpleNamespace

import pytest
from conftest import ROOT, require
from quiesce.base.errors import UsageError
from quiesce.cli.main import main
from quiesce.firmware import container, making
from quiesce.firmware.image import BOOT_BYTES, SEAL_BYTES, digest_of, image_of, read_image, sealed
from quiesce.firmware.making import Made
from quiesce.firmware.release import (
    UPDATABLE,
    UPDATABLE_SIGNED,
    refusal,
    signed_file,
    update_ending,
    write_release,
    write_sums,
)

BOARD = "nucleo_f446re"
NAME = f"quiesce_{BOARD}-0.1.0"


@pytest.fixture(scope="module")
def elf() -> Path:
    return require(ROOT / f"build/stm32f4/targets/stm32f4/quiesce_stm32f4_{BOARD}.elf")


@pytest.fixture(scope="module")
def keys(tmp_path_factory) -> SimpleNamespace:
    folder = tmp_path_factory.mktemp("keys")
    made = {}
    for name in ("maker", "other"):
        private, public = folder / f"{name}.pem", folder / f"{name}_public.pem"
        assert main(["firmware", "key", str(private), str(public)]) == 0
        made[name] = SimpleNamespace(private=private, public=public)
    return SimpleNamespace(**made)


@pytest.fixture
def release(tmp_path: Path, elf: Path, keys) -> Path:
    folder = tmp_path / "release"
    folder.mkdir()
    write_release(Made.of(elf), keys.maker.private, "12.2.1", folder)
    return folder


def test_all_forms_hold_the_same_sealed_image(release: Path, elf: Path) -> None:
    images = [read_image(release / f"{NAME}.{end}") for end in ("elf", "hex", "bin", "signed.bin")]
    assert len({image.payload for image in images}) == 1
    image = images[0]
    assert image.is_whole and not read_image(elf).is_sealed
    assert (image.board, image.version_text, image.begin) == (BOARD, "0.1.0", 0x08000000)
    assert image.payload[: -len(image.seal)] == read_image(elf).payload[: -len(image.seal)]


def test_updates_are_the_same_image_for_each_place(release: Path, keys) -> None:
    for slot, begin in enumerate((0x08004000, 0x08020000)):
        file = release / f"{NAME}{update_ending(slot)}"
        image = read_image(file)
        assert image.is_whole and image.begin == begin
        assert (image.board, image.version_text) == (BOARD, "0.1.0")
        assert refusal(release, keys.maker.public, BOARD, None, update_ending(slot)) == ""
    first = read_image(release / f"{NAME}{UPDATABLE}")
    assert first.payload == read_image(release / f"{NAME}{update_ending(0)}").payload


def test_what_goes_with_it(release: Path) -> None:
    parts = json.loads((release / "sbom.cdx.json").read_text())
    assert parts["specVersion"] == "1.6"
    firmware = parts["metadata"]["component"]
    assert firmware["name"] == f"quiesce-{BOARD}"
    names = {one["name"] for one in parts["components"]}
    assert names == {"stm32f4", "libgcc and newlib"}
    assert "dfu-util" in (release / "FLASH.md").read_text()
    assert ".text" in (release / "sizes.txt").read_text()
    assert str(ROOT) not in (release / f"{NAME}.map").read_text()
    listed = (release / "SHA256SUMS").read_text().split()[1::2]
    assert sorted(listed) == sorted(f.name for f in release.iterdir() if f.name != "SHA256SUMS")


def test_the_same_image_twice_is_the_same_folder(release: Path, elf: Path, keys) -> None:
    again = release.parent / "again"
    again.mkdir()
    write_release(Made.of(elf), keys.maker.private, "12.2.1", again)
    assert (again / "SHA256SUMS").read_text() == (release / "SHA256SUMS").read_text()


def test_verify_and_a_dry_flash(capsys, release: Path, keys) -> None:
    words = [str(release), "--key", str(keys.maker.public), "--board", BOARD]
    assert main(["firmware", "verify", *words, "--at-least", "0.1.0"]) == 0
    assert "whole, signed" in capsys.readouterr().out
    assert main(["firmware", "flash", *words, "--with", "openocd", "--dry-run"]) == 0
    said = capsys.readouterr().out
    assert f"program {{{NAME}.bin}} verify reset exit 0x08000000" in said


def test_what_is_flashed_with_boot_code_is_what_was_signed(capsys, release: Path, keys) -> None:
    words = [str(release), "--updatable", "--with", "openocd", "--dry-run"]
    words += ["--key", str(keys.maker.public)]
    assert main(["firmware", "flash", *words]) == 0
    assert f"program {{{NAME}{UPDATABLE}}}" in capsys.readouterr().out
    file = release / f"{NAME}{UPDATABLE_SIGNED}"
    data = file.read_bytes()
    assert container.payload_of(data) == (release / f"{NAME}{UPDATABLE}").read_bytes()
    for at in (100, BOOT_BYTES + 5000):  # of the boot code, and of the image
        broken = bytearray(data)
        broken[at] ^= 1
        file.write_bytes(broken)
        write_sums(release)
        assert main(["firmware", "flash", *words]) == 1
        assert file.name in capsys.readouterr().out
    container.sign(container.payload_of(data), "0.1.0", keys.other.private, file)
    write_sums(release)
    assert main(["firmware", "flash", *words]) == 1
    assert "not signed by this key" in capsys.readouterr().out


def test_an_update_is_not_flashed_where_boot_code_is(capsys, release: Path) -> None:
    file = release / f"{NAME}{update_ending(1)}"
    assert main(["firmware", "flash", str(file), "--with", "openocd", "--dry-run"]) == 2
    told = capsys.readouterr()
    assert told.out == "" and "linked for 0x08020000, behind boot code" in told.err


def put(release: Path, data: bytes) -> None:
    """Into the signed image, with sums that fit."""
    signed_file(release).write_bytes(data)
    write_sums(release)


def test_every_damaged_byte_is_refused(release: Path, keys) -> None:
    data = signed_file(release).read_bytes()
    places = [*range(64), *range(64, len(data), 997), *range(len(data) - 160, len(data))]
    # Of the header: reserved, or what MCUboot alone goes by, and hashed as all of it is.
    for at in places:
        broken = bytearray(data)
        broken[at] ^= 0x40
        put(release, bytes(broken))
        assert refusal(release, keys.maker.public, None, None), at


def test_every_truncated_image_is_refused(release: Path, keys) -> None:
    data = signed_file(release).read_bytes()
    for length in [*range(48), *range(48, len(data), 4099), *range(len(data) - 180, len(data))]:
        put(release, data[:length])
        for key in (keys.maker.public, None):
            # Without a key only what lies before the signature's own record is looked at.
            if key or length < len(data) - 70:
                assert refusal(release, key, None, None), length


def test_another_maker_and_no_signature_are_refused(release: Path, keys, elf: Path) -> None:
    assert "not signed by this key" in refusal(release, keys.other.public, None, None)
    image = read_image(elf)
    container.sign(sealed(image.payload), "0.1.0", None, signed_file(release))
    write_sums(release)
    assert refusal(release, keys.maker.public, None, None)
    assert refusal(release, None, None, None) == ""


def test_wrong_board_and_older_versions_are_refused(capsys, release: Path) -> None:
    assert "for nucleo_f446re, not for olimex_h405" in refusal(release, None, "olimex_h405", None)
    assert main(["firmware", "verify", str(release), "--at-least", "0.2.0"]) == 1
    assert "version 0.1.0 is older than 0.2.0" in capsys.readouterr().out
    words = ["--with", "openocd", "--dry-run", "--board", "olimex_h405"]
    assert main(["firmware", "flash", str(release), *words]) == 1
    assert "openocd" not in capsys.readouterr().out


def test_a_seal_that_is_signed_and_wrong_is_refused(release: Path, keys, elf: Path) -> None:
    payload = bytearray(sealed(read_image(elf).payload))
    payload[5000] ^= 1
    container.sign(bytes(payload), "0.1.0", keys.maker.private, signed_file(release))
    write_sums(release)
    assert "seal is not that" in refusal(release, keys.maker.public, None, None)
    container.sign(read_image(elf).payload, "0.1.0", keys.maker.private, signed_file(release))
    write_sums(release)
    assert refusal(release, keys.maker.public, None, None) == "not sealed"


def test_a_container_of_another_version_is_refused(release: Path, keys, elf: Path) -> None:
    payload = sealed(read_image(elf).payload)
    container.sign(payload, "0.2.0", keys.maker.private, signed_file(release))
    write_sums(release)
    why = refusal(release, keys.maker.public, None, (0, 2, 0))
    assert why == "the container says version 0.2.0, the image 0.1.0"


def test_files_beside_the_image_count(release: Path) -> None:
    (release / "FLASH.md").write_text("short the bridge")
    assert refusal(release, None, None, None) == "FLASH.md is not the file of SHA256SUMS"
    write_sums(release)
    (release / "more.txt").write_text("")
    assert refusal(release, None, None, None) == "more.txt is not in SHA256SUMS"
    (release / "more.txt").unlink()
    (release / "sizes.txt").unlink()
    assert refusal(release, None, None, None) == "sizes.txt is missing"
    (release / "SHA256SUMS").unlink()
    assert "SHA256SUMS is missing" in refusal(release, None, None, None)


def test_info(capsys, release: Path) -> None:
    file = release / f"{NAME}.hex"
    assert main(["firmware", "info", str(file), "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert told["board"] == BOARD and told["is_whole"] and told["tables"] == []
    assert told["seal"] == read_image(file).seal.hex()
    assert main(["firmware", "info", str(file)]) == 0
    assert "whole" in capsys.readouterr().out


def test_what_is_read_out_of_flash_may_go_on(release: Path) -> None:
    data = (release / f"{NAME}.bin").read_bytes()
    image = image_of(data + b"\xff" * 5000, Path("read.bin"))
    assert image.payload == data and image.is_whole


def edited(data: bytes, word: int, value: int) -> bytes:
    """One word of what the image says of itself, sealed again."""
    at = data.index(b"QIMG") + 4 * word
    changed = data[:at] + struct.pack("<I", value) + data[at + 4 :]
    return changed[:-SEAL_BYTES] + digest_of(changed)


FAULTS = [
    (lambda data: b"", "do not say what it is"),
    (lambda data: data.replace(b"QIMG", b"QIMH"), "do not say what it is"),
    (lambda data: edited(data, 1, 2), "do not say what it is"),
    (lambda data: edited(data, 4, 0x08008000), "was linked for 0x08008000"),
    (lambda data: edited(data, 5, 0x08F00000), "is cut off"),
    (lambda data: edited(data, 5, 0x07F00000), "is cut off"),
    (lambda data: edited(data, 6, 0x20000000), "lies at 0x20000000, outside of itself"),
    (lambda data: edited(data, 7, 0x20000000), "lies at 0x20000000, outside of itself"),
    (lambda data: edited(data, 7, 0x08000000), "outside of itself"),
    (lambda data: data[:1000], "is cut off"),
    (lambda data: data[:460], "is cut off"),
    (lambda data: b"\x7fELF" + data, "a damaged ELF file"),
    (lambda data: b":0102", "a damaged Intel HEX file"),
    (lambda data: b":00000001FF", "loads nothing"),
    (lambda data: struct.pack("<I", container.MAGIC), "cut off in its header"),
    (lambda data: struct.pack("<I", container.MAGIC) + b"\xff" * 60, "is cut off"),
]


@pytest.mark.parametrize(("make", "words"), FAULTS)
def test_what_is_no_image_is_one_line(capsys, release: Path, make, words: str) -> None:
    file = release.parent / "bad.bin"
    file.write_bytes(make((release / f"{NAME}.bin").read_bytes()))
    assert main(["firmware", "info", str(file)]) == 2
    said = capsys.readouterr().err
    assert words in said and "bad.bin: " in said and said.count("\n") == 1


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["info", "none.bin"], "No such file or directory"),
        (["verify", "."], "SHA256SUMS is missing"),
        (["verify", "x", "--at-least", "one"], "--at-least one: no version"),
        (["verify", "none.signed.bin"], "No such file or directory"),
        (["build", "nucleo"], "no board 'nucleo'; there are nucleo_f446re, olimex_h405"),
        (["build", BOARD, "--table", "a.fis"], "a.fis: no table file; its name ends in .table"),
        (["build", BOARD, "--table", "a.table"], "No such file or directory"),
        (["flash", "x", "--with", "hammer"], "invalid choice: 'hammer'"),
    ],
)
def test_bad_arguments(capsys, monkeypatch, tmp_path: Path, words: list[str], message: str) -> None:
    monkeypatch.chdir(tmp_path)
    code = main(["firmware", *words])
    told = capsys.readouterr()
    assert message in told.out + told.err
    assert code == (1 if message.startswith("SHA256SUMS") else 2)
    assert (told.out + told.err).count("\n") == 1


def test_keys(capsys, tmp_path: Path, release: Path, keys) -> None:
    for file, words in (
        (tmp_path / "none.pem", "No such file or directory"),
        (release / "FLASH.md", "no key; name a public ed25519 key"),
    ):
        assert main(["firmware", "verify", str(release), "--key", str(file)]) == 2
        assert words in capsys.readouterr().err
    with pytest.raises(UsageError, match="another kind of key; name a private"):
        container.read_key(keys.maker.public, is_private=True)
    assert keys.maker.private.stat().st_mode & 0o077 == 0
    before = keys.maker.private.read_bytes()
    assert main(["firmware", "key", str(keys.maker.private), str(tmp_path / "p.pem")]) == 2
    assert "keys are not written over" in capsys.readouterr().err
    assert keys.maker.private.read_bytes() == before and not (tmp_path / "p.pem").exists()


def test_a_build_leaves_other_files_alone(capsys, monkeypatch, tmp_path: Path, elf: Path) -> None:
    monkeypatch.setattr(making, "run", lambda *_: None)
    monkeypatch.setattr(making, "build_folder", lambda: tmp_path / "build")
    made = tmp_path / f"build/firmware/cmake/targets/stm32f4/quiesce_stm32f4_{BOARD}.elf"
    made.parent.mkdir(parents=True)
    for name in Made.of(elf).targets():
        shutil.copy(elf.with_stem(name), made.with_stem(name))
    made.with_name(made.name + ".map").write_text("map")
    out = tmp_path / "out"
    assert main(["firmware", "build", BOARD, "--out", str(out)]) == 0
    assert "no: a hash alone" in capsys.readouterr().out
    assert main(["firmware", "build", BOARD, "--out", str(out)]) == 0
    assert main(["firmware", "verify", str(out)]) == 0
    (out / "notes.txt").write_text("mine")
    assert main(["firmware", "build", BOARD, "--out", str(out)]) == 2
    assert "has notes.txt, which is of no build" in capsys.readouterr().err
    assert (out / "notes.txt").read_text() == "mine"
