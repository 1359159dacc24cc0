"""`quiesce table`: what is told of a table file, by whom it is taken, what differs."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from conftest import ROOT
from quiesce.cli.main import main
from quiesce.damper.bank.table import Bank, ConstantModel, Element, bank_words
from quiesce.damper.force_map import Map, words_of_map
from quiesce.damper.inverse import VELOCITY
from quiesce.law.forms.friction import BACK, OUTWARD, FrictionSection, FrictionTable
from quiesce.rules.formats.files import read_rules
from quiesce.rules.integers.compile import compile_base
from quiesce.rules.integers.table import table_words
from quiesce.table.file import read_file, read_words, table_bytes
from quiesce.table.kinds import KINDS, LEARNT, MAP, RULES
from quiesce.table.words import crc_of, sealed
from quiesce.tune.phase_table import read_law
from quiesce.tune.phase_words import law_words

BOARD = ROOT / "sim_hil/data/boards/two_storeys.toml"
OTHER = ROOT / "sim_hil/data/boards/three_storeys_1996.toml"
RIG = ROOT / "firmware/plants/squeeze_2012"
FRICTION = FrictionTable((FrictionSection(5000, 100000, 30000, 200, OUTWARD | BACK),))


def pulses():
    return read_law(RIG / "pulses.phase.toml")


def rules(*, for_controller: bool = True) -> list[int]:
    base = read_rules(RIG / "rules.fcl")
    return table_words(
        compile_base(base, [1e-6, 1e-6], [1e-3]) if for_controller else compile_base(base)
    )


def force_map(top_mN: float = 2.0) -> list[int]:
    places = np.array([-0.1, 0.1])
    return words_of_map(
        Map(VELOCITY, places, np.array([0.0, 2.0]), np.array([[-1.0, -2.0], [1.0, top_mN]]))
    )


def bank() -> list[int]:
    models = (ConstantModel(0, 0, 0, (1 << 20,)), ConstantModel(1000, 5, 0, (1 << 21,)))
    return bank_words([Bank(1000, 20, 0, 0, (Element(False, 1 << 20, 1000),), models)])


def learnt(trims: dict[int, tuple[int, int, int, int]]) -> list[int]:
    """Words as firmware/law/phase/adapt_store.h has them: trims by the point's number."""
    owned = [0xAB, 1]
    for point in range(1, 65):
        halves = [value % 65536 for value in trims.get(point, (0, 0, 0, 0))]
        owned += [halves[0] | halves[1] << 16, halves[2] | halves[3] << 16]
    return sealed(LEARNT.magic, [0x31444151, crc_of(owned), *owned])


def write(file: Path, words: list[int], board: int = 0) -> str:
    file.write_bytes(table_bytes(words, board))
    return str(file)


def told(capsys: pytest.CaptureFixture[str], *words: object) -> tuple[int, str]:
    code = main(["table", *map(str, words)])
    found = capsys.readouterr()
    return code, " ".join((found.out + found.err).split())


SHOWN = [
    (
        "rules",
        rules,
        ["taken by law fuzzy, law fuzzy_selftune", "1: frequency 1 lowest 10 Hz 5 Hz"],
    ),
    ("rules", lambda: rules(for_controller=False), ["1: input 1 1 lowest 13107"]),
    (
        "pulses",
        lambda: law_words(pulses()),
        ["setting balanced", "4.500 120.48 deg 108.23 deg 5 A"],
    ),
    ("friction", FRICTION.words, ["law friction, demands force", "5000 N/m", "30 N"]),
    ("map", force_map, ["tracker inverse", "velocity m/s 0 A 2 A", "0.1 1 2", "version 2"]),
    ("bank", bank, ["for 1000 ticks a second", "1 A 0.005 N 0 2", "0.9766 1/s 1 mm/s no"]),
    (
        "learnt",
        lambda: learnt({7: (-364, 728, -3277, 0), 64: (0, 0, 0, 1)}),
        [
            "2, what was learnt",
            "law phase",
            "CRC 0x000000ab, setting balanced",
            "7 -1.00 deg +2.00 deg -10.00 % with",
            "64 +0.00 deg +0.00 deg +0.00 % without",
        ],
    ),
    ("learnt", lambda: learnt({}), ["nothing yet"]),
]


@pytest.mark.parametrize(("kind", "words", "parts"), SHOWN)
def test_show_tells_head_and_contents(tmp_path: Path, capsys, kind: str, words, parts) -> None:
    made = words()
    file = write(tmp_path / "x.table", made)
    code, text = told(capsys, "show", file)
    assert code == 0
    for part in [f"kind {kind}, version", "board any", f"0x{made[1]:08x}", *parts]:
        assert part in text
    assert f"{len(made)} words, {4 * len(made)} of 8192 bytes" in text


def test_show_tells_programs(tmp_path: Path, capsys) -> None:
    file = write(tmp_path / "x.table", force_map(), 77)
    assert main(["table", "show", file, "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["kind"] == "map" and found["road"] == 1 and found["trackers"] == ["inverse"]
    assert (found["board"], found["magic"], found["words"]) == (77, MAP.magic, 15)
    assert (found["bytes"], found["most_bytes"], found["laws"]) == (60, 8192, [])
    assert found["contents"][0].startswith("damper 1: force in N over velocity")


def test_show_knows_the_head_of_a_kind_that_it_does_not_know(tmp_path: Path, capsys) -> None:
    code, text = told(capsys, "show", write(tmp_path / "x.table", sealed(0x31585858, [1])))
    assert code == 0 and "kind 0x31585858, not known here" in text


def test_pulses_are_drawn_and_other_kinds_are_not(tmp_path: Path, capsys) -> None:
    file, out = write(tmp_path / "x.table", law_words(pulses())), tmp_path / "x.svg"
    code, text = told(capsys, "show", file, "--plot", out)
    assert code == 0 and "written" in text and out.stat().st_size > 1000
    code, text = told(capsys, "show", file, "--plot", tmp_path / "x.doc")
    assert code == 2 and "ends in .svg, .png, .pdf" in text
    code, text = told(capsys, "show", write(tmp_path / "m.table", force_map()), "--plot", out)
    assert code == 2 and "no picture of map" in text


@pytest.mark.parametrize("action", ["show", "check", "diff", "stamp"])
@pytest.mark.parametrize("what", ["none", "folder", "text", "cut", "empty"])
def test_what_is_no_table_file_ends_with_2(
    build: Path, tmp_path: Path, capsys, action: str, what: str
) -> None:
    good = table_bytes(force_map())
    for name, data in (("text", b"0x31\n"), ("cut", good[:-3]), ("empty", b"")):
        (tmp_path / name).write_bytes(data)
    (tmp_path / "folder").mkdir()
    file = tmp_path / what
    more = {"diff": [file], "stamp": ["--any"]}.get(action, [])
    code, text = told(capsys, action, file, *more)
    assert code == 2 and text.startswith("quiesce: ") and what in text


@pytest.mark.parametrize("action", ["show", "diff", "stamp"])
def test_a_damaged_table_is_told(tmp_path: Path, capsys, action: str) -> None:
    words = force_map()
    words[-1] ^= 1
    file = write(tmp_path / "x.table", words)
    more = {"diff": [file], "stamp": ["--any"]}.get(action, [])
    code, text = told(capsys, action, file, *more)
    assert code == 2 and "x.table: its CRC-32 is not that of its words: it is damaged" in text


@pytest.mark.parametrize(
    ("place", "text"),
    [(0, "not what this version's law phase learns"), (1, "has another CRC"), (3, "setting 2")],
)
def test_what_was_learnt_is_shown_only_where_it_is_right(
    tmp_path: Path, capsys, place: int, text: str
) -> None:
    values = learnt({3: (1, 2, -3, 0)})[3:]
    values[place] = 2
    values[1] = values[1] if place == 1 else crc_of(values[2:])
    code, told_text = told(
        capsys, "show", write(tmp_path / "x.table", sealed(LEARNT.magic, values))
    )
    assert code == 2 and text in told_text


def test_check_has_the_controllers_verdict(build: Path, tmp_path: Path, capsys) -> None:
    file = tmp_path / "x.table"
    code, text = told(capsys, "check", write(file, force_map()))
    assert (code, text) == (0, f"{file}: accepted by tracker inverse")
    damaged = force_map()
    damaged[-1] ^= 1
    code, text = told(capsys, "check", write(file, damaged))
    assert (code, text) == (1, f"{file}: refused: its checksum is wrong: it is damaged")
    code, text = told(capsys, "check", write(file, rules(for_controller=False)))
    assert code == 1 and "compile them with --controller" in text
    code, text = told(capsys, "check", write(file, sealed(0x31585858, [1])))
    assert code == 1 and "not a table for this law or tracker" in text


def test_check_asks_the_board(build: Path, tmp_path: Path, capsys) -> None:
    file = tmp_path / "x.table"
    three = FrictionTable(FRICTION.sections * 3)
    code, text = told(capsys, "check", write(file, three.words()))
    assert code == 0 and text.endswith("accepted by law friction")
    code, text = told(capsys, "check", file, "--board", BOARD)  # of two dampers
    assert code == 1 and "a damper that this board does not have" in text
    code, text = told(capsys, "check", write(file, FRICTION.words()), "--board", BOARD)
    assert code == 0 and "two_storeys.toml by law friction" in text
    assert told(capsys, "check", file, "--board", "none.toml")[0] == 2
    write(file, FRICTION.words(), 5)
    code, text = told(capsys, "check", file, "--board", BOARD)
    assert code == 1 and "made for board 0x00000005, and this is another one" in text
    assert main(["table", "check", str(file), "--board", str(BOARD), "--json"]) == 1
    found = json.loads(capsys.readouterr().out)
    assert not found["accepted"] and found["verdict"] == 0 and "another one" in found["why"]
    assert told(capsys, "check", file)[0] == 0


def test_takers_are_those_of_the_firmware(build: Path, tmp_path: Path, capsys) -> None:
    for kind in KINDS.values():
        file = write(tmp_path / "x.table", sealed(kind.magic, [0] * 40))
        main(["table", "check", file, "--json"])
        found = json.loads(capsys.readouterr().out)
        if kind != LEARNT:  # a law takes it beside a table
            assert found["laws"] == list(kind.laws), kind
            assert found["trackers"] == list(kind.trackers), kind


def test_stamp_names_a_board_and_takes_it_away(build: Path, tmp_path: Path, capsys) -> None:
    file = tmp_path / "x.table"
    write(file, FRICTION.words())
    code, text = told(capsys, "stamp", file, "--board", BOARD)
    board = read_file(file).board
    assert code == 0 and text == f"{file}: for board 0x{board:08x}" and board != 0
    assert told(capsys, "check", file, "--board", BOARD)[0] == 0
    assert "another one" in told(capsys, "check", file, "--board", OTHER)[1]
    assert f"board 0x{board:08x}" in told(capsys, "show", file)[1]
    assert told(capsys, "stamp", file, "--any") == (0, f"{file}: for board any")
    assert (read_file(file).board, read_words(file)) == (0, FRICTION.words())
    assert told(capsys, "stamp", file)[0] == 2
    assert told(capsys, "stamp", file, "--any", "--board", BOARD)[0] == 2
    assert told(capsys, "stamp", file, "--board", "none.toml")[0] == 2
    assert read_file(file).board == 0


def test_what_is_made_for_a_board_names_it(build: Path, tmp_path: Path, capsys) -> None:
    law, file = tmp_path / "law.table", tmp_path / "x.table"
    assert main(["law", "make", "skyhook_on_off", "--board", str(BOARD), "-o", str(law)]) == 0
    write(file, FRICTION.words())
    told(capsys, "stamp", file, "--board", BOARD)
    assert read_file(law).board == read_file(file).board


def test_diff_is_in_the_kinds_own_terms(tmp_path: Path, capsys) -> None:
    law = pulses()
    points = list(law.settings["balanced"])
    points[3] = replace(points[3], floor_mA=points[3].floor_mA + 100)
    other = replace(law, settings={**law.settings, "balanced": tuple(points)})
    a, b = write(tmp_path / "a", law_words(law)), write(tmp_path / "b", law_words(other))
    code, text = told(capsys, "diff", a, b)
    assert code == 1
    assert f"{a}, {b}: pulses, version 1; 1 word differs setting balanced - 5.500 " in text
    assert " 5 A 0.1 A " in text and "displacement" not in text
    assert told(capsys, "diff", a, a) == (0, f"{a}, {a}: the same, pulses, version 1")
    assert main(["table", "diff", a, b, "--json"]) == 1
    found = json.loads(capsys.readouterr().out)
    (part,) = found["parts"]
    assert not found["same"] and part["heading"] == "setting balanced"
    assert len(part["removed"]) == len(part["added"]) == 1


def test_diff_falls_back_on_words(tmp_path: Path, capsys) -> None:
    """A place of a map in um/s: less than its text tells."""
    near = Map(
        VELOCITY, np.array([-0.1, 0.1]), np.array([0.0, 2.0]), np.array([[-1, -2], [1, 2.0]])
    )
    far = replace(near, places=np.array([-12.345678, 0.1]))
    farther = replace(near, places=np.array([-12.345679, 0.1]))
    a, b = (write(tmp_path / name, words_of_map(one)) for name, one in (("a", far), ("b", farther)))
    code, text = told(capsys, "diff", a, b)
    assert code == 1 and "1 word differs word 7: 0xff439eb2, 0xff439eb1" in text


def test_diff_tells_kinds_boards_and_sizes(tmp_path: Path, capsys) -> None:
    a = write(tmp_path / "a", law_words(pulses()))
    code, text = told(capsys, "diff", a, write(tmp_path / "b", FRICTION.words(), 9))
    assert code == 1 and "pulses, version 1 and friction, version 1" in text
    assert "board any and 0x00000009" in text and "words 301 and 9" in text
    code, text = told(capsys, "diff", a, write(tmp_path / "b", law_words(pulses()), 9))
    assert code == 1 and text.endswith("0 words differ board any and 0x00000009")


def test_pack_takes_text_and_bytes(tmp_path: Path, capsys) -> None:
    words = force_map()
    out = tmp_path / "out/x.table"
    data = table_bytes(words)[16:]
    for text in (
        data,
        "\n".join(f"{one:08x}" for one in words).encode(),
        b"0x%X " * 15 % tuple(words),
    ):
        (tmp_path / "bare").write_bytes(text)
        code, said = told(capsys, "pack", tmp_path / "bare", "-o", out)
        assert (code, said) == (0, f"{out}: map, version 2, 15 words, 60 bytes")
        assert read_words(out) == words


@pytest.mark.parametrize(
    ("data", "why"),
    [
        (b"", "expected the words of a table"),
        (b"FUNCTION_BLOCK", "expected the words of a table"),
        (b"-1", "expected the words of a table"),
        (b"1FFFFFFFF", "expected the words of a table"),
        (b"\xff\xfe\xfd", "expected the words of a table"),
        (b"1 2 3", "expected 4 .. 2048 words"),
        (b"31475351 0 5 1 2", "it is damaged"),
        (b"31475351 0 9 1 2", "5 words where its head says 9"),
        (table_bytes(force_map()), "it is a table file already"),
        (table_bytes(force_map())[16:-1], "59 bytes are no whole 32-bit words"),
        (b"0 " * 2049, "a table of 2049 words, 8196 bytes; a controller takes 2048 words"),
    ],
)
def test_pack_refuses(tmp_path: Path, capsys, data: bytes, why: str) -> None:
    file, out = tmp_path / "bare", tmp_path / "x.table"
    file.write_bytes(data)
    code, text = told(capsys, "pack", file, "-o", out)
    assert code == 2 and why in text and text.startswith(f"quiesce: {file}: ")
    assert not out.exists()
    assert told(capsys, "pack", tmp_path / "none", "-o", out)[0] == 2


def rules_text(rules: int) -> str:
    lines = "".join(
        f"RULE {i + 1}: IF x IS {'low' if i % 2 else 'high'} THEN y IS p;\n" for i in range(rules)
    )
    return f"""FUNCTION_BLOCK many
VAR_INPUT x : REAL; END_VAR
VAR_OUTPUT y : REAL; END_VAR
FUZZIFY x
RANGE := (0 .. 1);
TERM low := (0, 1) (1, 0);
TERM high := (0, 0) (1, 1);
END_FUZZIFY
DEFUZZIFY y
RANGE := (0 .. 1);
TERM p := 1;
METHOD : COGS;
ACCU : SUM;
DEFAULT := 0;
END_DEFUZZIFY
RULEBLOCK r
AND : MIN;
{lines}END_RULEBLOCK
END_FUNCTION_BLOCK
"""


def test_rules_too_many_for_a_controller_have_c_and_no_table(tmp_path: Path, capsys) -> None:
    for rules in (10, 700):
        file, out = tmp_path / f"r{rules}.fcl", tmp_path / f"out{rules}"
        file.write_text(rules_text(rules))
        assert main(["rules", "compile", str(file), "--out", str(out)]) == 0
        said = capsys.readouterr().out
        assert (out / f"r{rules}.c").is_file()
        assert (out / f"r{rules}.table").exists() == (rules == 10)
        assert (f"r{rules}.table" in said) == (rules == 10)
        assert ("a controller takes 2048 words, 8192 bytes" in said) == (rules == 700)
    assert read_words(tmp_path / "out10/r10.table")[0] == RULES.magic
