"""QUIESCE_TABLES: files of tables become words in C that the node image links, or one line."""

import re
import struct
import subprocess
from pathlib import Path

import pytest
from conftest import ROOT, Result
from quiesce.table.file import table_bytes
from quiesce.table.kinds import LINEAR
from quiesce.table.words import sealed

FOLDER = ROOT / "targets/node"
SMALL = table_bytes(sealed(LINEAR.magic, [7]), board=5)
LARGEST = table_bytes(sealed(LINEAR.magic, range(2045)))


def convert(folder: Path, *files: bytes) -> Result:
    names = [folder / f"{i}.table" for i in range(len(files))]
    for name, data in zip(names, files, strict=True):
        name.write_bytes(data)
    tables = f"-DTABLES={';'.join(map(str, names))}"
    command = ["cmake", tables, f"-DOUT={folder}/out.c", "-P", FOLDER / "table_words.cmake"]
    return subprocess.run(command, capture_output=True, text=True)


@pytest.mark.parametrize("files", [(), (SMALL,), (LARGEST, SMALL)], ids=len)
def test_words_are_those_of_the_files(tmp_path: Path, files: tuple[bytes, ...]) -> None:
    assert convert(tmp_path, *files).returncode == 0
    source = tmp_path / "out.c"
    strict = ["gcc", "-fsyntax-only", "-std=c11", "-Wall", "-Wextra", "-Werror", f"-I{FOLDER}"]
    assert subprocess.run([*strict, source]).returncode == 0
    tables = re.findall(r"table_\d\[\] = \{(.*?)\};", source.read_text(), re.DOTALL)
    words = [[int(word, 16) for word in re.findall(r"0x(\w{8})u", table)] for table in tables]
    assert words == [list(struct.unpack(f"<{len(one) // 4}I", one)) for one in files]
    assert source.read_text().endswith("NULL};\n")


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (b"", "is no table: it has 0 bytes, a table 32 .. 8208"),
        (SMALL[:28], "is no table: it has 28 bytes"),
        (LARGEST + b"1234", "is no table: it has 8212 bytes"),
        (b"x" * 64, "is no table: it begins with 0x78787878, not 0x31465451"),
        (SMALL[:-1], "is no table: it has 31 bytes"),
        (LARGEST[:-1], "has 8207 bytes; its head says 8208"),
        (SMALL + b"1", "has 33 bytes; its head says 32"),
        (
            LARGEST[:8] + b"\xff\xff\xff\xff" + LARGEST[12:],
            "has 8208 bytes; its head says 17179869196",
        ),
    ],
)
def test_a_file_that_is_no_table_ends_with_one_line(tmp_path: Path, data, message) -> None:
    result = convert(tmp_path, SMALL, data)
    assert result.returncode != 0
    told = " ".join(result.stderr.split())  # CMake breaks lines
    assert told.count(".table: ") == 1 and f"{tmp_path}/1.table: {message}" in told, told
    assert not (tmp_path / "out.c").exists()
