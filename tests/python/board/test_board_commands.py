"""`quiesce board check`, `show` and `compile`."""

import struct
import subprocess
from pathlib import Path

import pytest
from conftest import ROOT
from quiesce.cli.board.show import law_rows, range_text
from quiesce_benchmarks.controller.boards import GOOD

BOARDS = ROOT / "sim_hil/data/boards"
TWO = BOARDS / "two_storeys.toml"
LARGEST = ["-DQUIESCE_SENSORS=8", "-DQUIESCE_BODIES=4", "-DQUIESCE_DAMPERS=4"]


def test_check_says_one_line_a_file(quiesce) -> None:
    bad = "none.toml"
    result = quiesce("board", "check", BOARDS / "squeeze_2012.toml", bad, TWO)
    assert result.returncode == 2
    assert [line.split(": ", 1)[1] for line in result.stdout.splitlines()] == [
        "ok: squeeze_2012, 1 sensor, 1 body, 1 damper",
        "ok: two_storeys, 3 sensors, 2 bodies, 2 dampers",
    ]
    assert result.stderr == "quiesce: none.toml: cannot be read; name a file that is there\n"


def test_every_board_that_ships_is_good(quiesce) -> None:
    files = sorted(BOARDS.glob("*.toml"))
    assert len(files) >= 2
    assert quiesce("board", "check", *files).returncode == 0


def rows(text: str) -> dict[str, list[str]]:
    """First cell -> the others; cells are two blanks apart."""
    cells = ([c.strip() for c in line.split("  ") if c.strip()] for line in text.splitlines())
    return {row[0]: row[1:] for row in cells if row}


def test_show_tells_sensors_dampers_signals_and_laws(quiesce) -> None:
    text = quiesce("board", "show", GOOD).stdout
    shown = rows(text)
    assert text.startswith(
        "every_key: bodies floor, roof; tracked roof_accel; bus 0.5 ms; CRC-32 0x"
    )
    assert shown["floor_accel"] == [
        "acceleration", "floor, x", "-57.751 um/s2", "-484.4 .. 484.5 m/s2", "4 ms", "20 ms",
        "stuck 300 ms, noise < 3, lost > 40 %", "1.5 ms, corner 0.25 Hz",
    ]  # fmt: skip
    assert shown["supply"][:3] == ["supply_voltage", "-", "12.5 mV"]
    assert shown["lower"] == [
        "floor - ground", "2 A", "0.1 A", "1.5 A, 45 s", "measured", "2.5 A for 1 ms",
        "6 ms, 2.2 Ohm",
    ]  # fmt: skip
    assert shown["upper"][4:6] == ["modelled", "-"]
    assert shown["stroke velocity"] == ["lower, upper"]
    assert shown["supply voltage"] == ["-"]
    assert shown["phase"] == ["yes"]


def test_show_leaves_out_what_no_sensor_tells(quiesce, tmp_path: Path) -> None:
    file = tmp_path / "one.toml"
    text = TWO.read_text()
    floor = text[text.index("[[sensor]]") : text.index('[[sensor]]\nname = "roof_accel"')]
    file.write_text(text.replace(floor, ""))
    shown = rows(quiesce("board", "show", file).stdout)
    assert shown["acceleration"] == shown["velocity"] == ["roof"]
    assert shown["stroke"] == ["upper"]
    assert "stroke velocity" not in shown


def test_a_law_that_lacks_a_signal_is_told() -> None:
    laws = {"off": None, "skyhook": "velocity of roof"}
    assert law_rows(laws) == [["off", "yes"], ["skyhook", "no: lacks velocity of roof"]]


def test_range_counts_offset_and_polarity() -> None:
    sensor = {"unit": "mV", "scale": 2000, "full_scale_counts": 1000, "offset_counts": 500}
    assert range_text(sensor | {"polarity": 1}) == "-3 .. 1 V"
    assert range_text(sensor | {"polarity": -1}) == "-1 .. 3 V"


PRINTER = """#include <stdio.h>
#include "quiesce_board.h"
extern const quiesce_board_t my_board;
int main(void) {
    fwrite(&my_board, sizeof my_board, 1, stdout);
    return !quiesce_board_check(&my_board, NULL);
}
"""


def compiled(folder: Path, *options: str) -> subprocess.CompletedProcess[bytes]:
    return subprocess.run(
        ["cc", "-std=c11", "-Wall", "-Wextra", "-Wpedantic", "-Werror", *options,
         "-I", str(ROOT / "firmware/include"), "board.c", "printer.c",
         str(ROOT / "firmware/board/board.c"), "-o", "printer"],
        cwd=folder, capture_output=True, timeout=120,
    )  # fmt: skip


@pytest.mark.parametrize("file", [GOOD, TWO, BOARDS / "squeeze_2012.toml"], ids=lambda f: f.stem)
def test_compiled_board_is_the_same_words(quiesce, tmp_path: Path, file: Path) -> None:
    options = ["--out", "board.c", "--symbol", "my_board", "--words", "board.words"]
    result = quiesce("board", "compile", file, *options)
    assert (result.returncode, result.stdout) == (0, "written    board.c, board.words\n")
    (tmp_path / "printer.c").write_text(PRINTER)
    built = compiled(tmp_path, *LARGEST)
    assert built.returncode == 0, built.stderr.decode()
    ran = subprocess.run([tmp_path / "printer"], capture_output=True, timeout=60)
    assert ran.returncode == 0
    words = [int(word, 16) for word in (tmp_path / "board.words").read_text().split()]
    assert [w for (w,) in struct.iter_unpack("<I", ran.stdout)] == words


def test_compiled_board_is_refused_by_a_smaller_build(quiesce, tmp_path: Path) -> None:
    assert quiesce("board", "compile", TWO, "--out", "board.c").returncode == 0
    (tmp_path / "printer.c").write_text("int main(void) { return 0; }\n")
    built = compiled(tmp_path)
    assert built.returncode != 0
    assert b"fewer sensors, bodies or dampers than board two_storeys has" in built.stderr


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["--out", "b.c", "--symbol", "9lives"], ["--symbol 9lives"]),
        (["--out", "b.c", "--symbol", "static"], ["--symbol static"]),
        (["--out", "b.c", "--symbol", "a;b"], ["--symbol a;b"]),
        (["--out", "."], ["--out .", "a folder"]),
        (["--out", "b.c", "--words", "b.c"], ["--words b.c", "--out"]),
        (["--out", str(TWO)], ["is the board itself"]),
        (["--out", "b.c", "--words", str(TWO)], ["--words", "is the board itself"]),
        ([], ["--out"]),
        (["--out", "/dev/null/b.c"], ["cannot write"]),
    ],
)
def test_compile_option_is_refused(refused, options, words) -> None:
    message = refused("board", "compile", TWO, *options)
    for word in words:
        assert word in message


@pytest.mark.parametrize("action", [["show"], ["compile", "--out", "b.c"]])
def test_bad_board_writes_nothing(refused, tmp_path: Path, action) -> None:
    (tmp_path / "bad.toml").write_text(TWO.read_text().replace("safe_mA = 0", "safe_mA = -1", 1))
    message = refused("board", action[0], "bad.toml", *action[1:])
    assert "bad.toml:34: damper[1].safe_mA: expected an integer in 0 .. 20000" in message
