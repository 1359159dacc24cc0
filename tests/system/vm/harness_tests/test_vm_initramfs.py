"""The guest's memory file system: archive, module order, libraries; without a machine."""

import shutil
import subprocess
from pathlib import Path

import pytest
from quiesce.base.errors import UsageError
from quiesce_vm import initramfs, libraries
from quiesce_vm.cpio import Archive
from quiesce_vm.kernel_modules import dependencies, load_order

ARM64_HEAD = b"\x7fELF\x02\x01\x01" + bytes(9) + b"\x03\x00\xb7\x00"
X86_HEAD = b"\x7fELF\x02\x01\x01" + bytes(9) + b"\x03\x00\x3e\x00"


def entries(archive: bytes) -> dict[str, tuple[int, bytes]]:
    """Mode and content by name, read as the kernel does."""
    found = {}
    offset = 0
    while True:
        assert archive[offset : offset + 6] == b"070701"
        fields = [int(archive[offset + 6 + 8 * i : offset + 14 + 8 * i], 16) for i in range(13)]
        start = offset + 110
        name = archive[start : start + fields[11] - 1].decode()
        start += fields[11] + -(start + fields[11]) % 4
        if name == "TRAILER!!!":
            return found
        assert name not in found
        found[name] = (fields[1], archive[start : start + fields[6]])
        offset = start + fields[6] + -fields[6] % 4


def test_archive_is_what_the_kernel_reads() -> None:
    archive = Archive()
    archive.add_file("a/b/program", b"12345")
    archive.add_file("a/list", b"", 0o644)
    archive.add_link("a/b/link", "program")
    archive.add_file("a/list", b"the first one stays")
    found = entries(archive.content())
    assert list(found) == ["a", "a/b", "a/b/program", "a/list", "a/b/link"]
    assert found["a/b/program"] == (0o100755, b"12345")
    assert found["a/list"] == (0o100644, b"")
    assert found["a/b/link"] == (0o120777, b"program")
    assert found["a"] == (0o040755, b"")


def module(folder: Path, name: str, needs: str) -> None:
    folder.mkdir(exist_ok=True)
    (folder / f"{name}.ko").write_bytes(
        b"\x7fELF...\0license=GPL\0depends=" + needs.encode() + b"\0"
    )


def test_modules_come_after_what_they_need(tmp_path: Path) -> None:
    module(tmp_path / "net", "can-raw", "can")
    module(tmp_path / "net", "can", "")
    module(tmp_path / "drivers", "slcan", "can-dev,can")
    module(tmp_path / "drivers", "can-dev", "")
    order = [file.stem for file in load_order(tmp_path, ["slcan", "can_raw"])]
    assert order == ["can-dev", "can", "slcan", "can-raw"]


def test_missing_module_is_told_with_who_needs_it(tmp_path: Path) -> None:
    module(tmp_path, "slcan", "can-dev")
    with pytest.raises(UsageError, match="can-dev .needed by slcan.*tests/system/vm/build_images"):
        load_order(tmp_path, ["slcan"])


@pytest.mark.parametrize("data", [b"", b"no module", b"\0depends=\0"])
def test_module_that_names_no_dependency_has_none(data: bytes) -> None:
    assert dependencies(data) == []


READELF = "aarch64-linux-gnu-readelf"


@pytest.mark.skipif(
    shutil.which(READELF) is None, reason="tests/system/vm/build_images installs it"
)
def test_file_that_is_no_program_is_refused(tmp_path: Path) -> None:
    file = tmp_path / "program"
    file.write_bytes(b"\x7fELF, but not quite")
    with pytest.raises(UsageError, match="not a program"):
        libraries.needed(file)


def fake_readelf(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Names as needed what the file holds, one library a line."""
    script = folder / READELF
    script.write_text(
        '#!/bin/sh\nfor last; do :; done\nsed "s/.*/ 0x01 (NEEDED)  Shared library: [&]/" "$last"\n'
    )
    script.chmod(0o755)
    monkeypatch.setenv("PATH", f"{folder}:/usr/bin:/bin")
    assert subprocess.run([READELF, "/dev/null"]).returncode == 0


def test_libraries_of_libraries(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    fake_readelf(tmp_path, monkeypatch)
    root, built = tmp_path / "root", tmp_path / "built"
    folder = root / "usr/lib/aarch64-linux-gnu"
    folder.mkdir(parents=True)
    built.mkdir()
    (tmp_path / "program").write_text("liba.so\nlibc.so\n")
    (folder / "liba.so").write_text("libb.so\n")
    (built / "libb.so").write_text("libc.so\n")
    (folder / "libc.so").write_text("")
    found = libraries.closure(root, [tmp_path / "program"], (built,))
    assert set(found) == {"liba.so", "libb.so", "libc.so"}
    assert found["libb.so"] == built / "libb.so"
    (folder / "libc.so").unlink()
    with pytest.raises(UsageError, match="libc.so.*tests/system/vm/images.sh"):
        libraries.closure(root, [tmp_path / "program"], (built,))


def test_program_of_another_processor_is_refused(tmp_path: Path) -> None:
    """An absolute link in an unpacked package would lead to this machine's own file."""
    archive = Archive()
    good, bad = tmp_path / "good", tmp_path / "bad"
    good.write_bytes(ARM64_HEAD)
    bad.write_bytes(X86_HEAD)
    initramfs._add(archive, "bin/good", good)
    with pytest.raises(UsageError, match="not for arm64"):
        initramfs._add(archive, "bin/bad", bad)
    with pytest.raises(UsageError, match="run tests/system/vm/build_images"):
        initramfs._add(archive, "bin/none", tmp_path / "none")


def test_missing_set_up_says_what_to_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("QUIESCE_BUILD", str(tmp_path))
    with pytest.raises(UsageError, match="run tests/system/vm/build_images"):
        initramfs.Parts.built()
