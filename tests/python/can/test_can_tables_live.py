"""Tables over CAN beside a real controller: the firmware's node in a process, SLCAN on a pty."""

import json
from collections.abc import Iterator
from pathlib import Path

import pytest
from can_bus import Controller, build_peer
from conftest import ROOT, Result
from quiesce.cli.main import main
from quiesce.rules.surface.words import is_surface
from quiesce.table import kinds
from quiesce.table.file import read_file, table_bytes
from quiesce.table.words import sealed

SQUEEZE = ROOT / "firmware/plants/squeeze_2012"
RULES = SQUEEZE / "rules.fcl"
PULSES = SQUEEZE / "pulses.phase.toml"
PRODUCTS = ROOT / "tools/benchmarks/rules/reference_product.fis"


@pytest.fixture(scope="session")
def peer(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return build_peer(tmp_path_factory.mktemp("can_peer"))


@pytest.fixture
def controller(peer: Path, tmp_path: Path) -> Iterator[Controller]:
    one = Controller(peer, tmp_path)
    yield one
    one.stop()


@pytest.fixture
def tool(controller: Controller, capsys: pytest.CaptureFixture[str]):
    """Runs an action on the controller's bus."""

    def run(*arguments: str | Path) -> Result:
        code = main(["can", *map(str, arguments), "--bus", controller.bus])
        return Result(arguments, code, *capsys.readouterr())

    return run


@pytest.fixture
def other_rules(tmp_path: Path) -> Path:
    """Those that ship, but for one term of the output."""
    text = RULES.read_text()
    assert "TERM medium := 2.5;" in text
    file = tmp_path / "other.fcl"
    file.write_text(text.replace("TERM medium := 2.5;", "TERM medium := 2.25;"))
    return file


def told(tool) -> dict[str, dict[str, object]]:
    result = tool("tables", "--json")
    assert result.returncode == 0, result.stderr
    return {one["road"]: one for one in json.loads(result.stdout)["roads"]}


def loaded(result: Result) -> str:
    """CRC of what is in use now."""
    assert result.returncode == 0, result.stdout + result.stderr
    return str(json.loads(result.stdout)["crc"])


def refused(result: Result, words: str) -> None:
    assert result.returncode == 1 and result.stdout == "", result
    assert words in result.stderr.splitlines()[-1], result.stderr


def test_an_armed_controller_takes_rules_and_gives_them_back(
    controller: Controller, tool, other_rules: Path, tmp_path: Path
) -> None:
    controller.start()
    shipped = told(tool)["law"]
    assert (shipped["kind"], shipped["source"]) == ("rules", "ships")
    dry = tool("load", "rules", other_rules, "--dry-run")
    assert dry.returncode == 0 and told(tool)["law"] == shipped
    crc = loaded(tool("load", "rules", other_rules, "--json"))
    now = told(tool)["law"]
    assert (now["crc"], now["source"], now["stored_crc"]) == (crc, "loaded", None)
    assert crc != shipped["crc"]
    # What comes out can go in again.
    fetched = tmp_path / "fetched.table"
    assert tool("fetch", "law", "-o", fetched).returncode == 0
    assert f"{read_file(fetched).words[1]:08x}" == crc
    assert tool("revert", "law").returncode == 0 and told(tool)["law"]["crc"] == shipped["crc"]
    refused(tool("revert", "law"), "there is no earlier table")
    assert loaded(tool("load", "law", fetched, "--json")) == crc


def test_rules_without_a_plain_table_arrive_as_their_surface(
    controller: Controller, tool, tmp_path: Path
) -> None:
    controller.start()
    result = tool("load", "rules", PRODUCTS, "--json")
    crc = loaded(result)
    assert "taken: the surface of its answers" in result.stderr
    now = told(tool)["law"]
    assert (now["kind"], now["crc"], now["source"]) == ("rules", crc, "loaded")
    fetched = tmp_path / "fetched.table"
    assert tool("fetch", "law", "-o", fetched).returncode == 0
    assert is_surface(read_file(fetched).words)


@pytest.mark.slow
def test_what_is_saved_is_there_after_a_restart(
    controller: Controller, tool, other_rules: Path, tmp_path: Path
) -> None:
    store = ("--store", str(tmp_path))
    controller.start(*store)
    shipped = told(tool)["law"]
    crc = loaded(tool("load", "rules", other_rules, "--save", "--json"))
    now = told(tool)["law"]
    assert (now["stored_crc"], now["writes"]) == (crc, 1)
    record = tmp_path / "record1"
    damaged = record.read_bytes()[:-1] + b"\x55"
    controller.stop()
    controller.start(*store)
    after = told(tool)["law"]
    assert (after["crc"], after["source"], after["refusal"]) == (crc, "stored", None)
    assert tool("revert", "law", "--shipped", "--save").returncode == 0
    now = told(tool)["law"]
    assert (now["crc"], now["stored_crc"], now["writes"]) == (shipped["crc"], None, 2)
    controller.stop()
    # A record that has changed by itself is told, and what ships is used.
    record.write_bytes(damaged)
    controller.start(*store)
    after = told(tool)["law"]
    assert (after["crc"], after["source"]) == (shipped["crc"], "ships")
    assert after["refusal"]["verdict"] == "CRC"


@pytest.mark.slow
def test_the_law_decides_what_it_takes(controller: Controller, tool, tmp_path: Path) -> None:
    controller.start("--idle")
    refused(
        tool("load", "pulses", PULSES),
        "the controller runs law fuzzy, which takes rules; this is pulses, for law phase: quiesce "
        "can set law=phase; nothing was changed",
    )
    refused(tool("restore-learnt"), "nothing that was learnt is stored")
    refused(tool("fetch", "tracker", "-o", tmp_path / "a.table"), "has no table")
    refused(tool("fetch", "learnt", "-o", tmp_path / "a.table"), "has no table")
    assert tool("set", "law=phase").returncode == 0
    crc = loaded(tool("load", "pulses", PULSES, "--json"))
    assert told(tool)["law"]["crc"] == crc
    refused(tool("load", "rules", RULES), "runs law phase, which takes pulses; this is rules")


@pytest.mark.slow
def test_what_was_learnt_is_kept_and_put_back(controller: Controller, tool, tmp_path) -> None:
    controller.start("--idle", "--store", str(tmp_path))
    assert tool("set", "law=phase").returncode == 0
    file = tmp_path / "learnt.table"
    result = tool("save-learnt", file)
    assert result.returncode == 0, result.stderr
    assert told(tool)["learnt"]["stored_crc"] == f"{read_file(file).words[1]:08x}"
    assert read_file(file).words[0] == kinds.LEARNT.magic
    for words in (["forget-learnt"], ["restore-learnt"], ["restore-learnt", file]):
        result = tool(*words)
        assert result.returncode == 0, result.stderr
    assert tool("set", "law=fuzzy").returncode == 0
    refused(tool("restore-learnt", file), "it was learnt by another law")
    refused(tool("restore-learnt"), "it was learnt by another law")


def test_boards_damage_and_stores_that_fail(controller: Controller, tool, tmp_path: Path) -> None:
    controller.start("--no-store")
    crc = told(tool)["law"]["crc"]
    file = tmp_path / "a.table"
    assert tool("fetch", "law", "-o", file).returncode == 0
    words = read_file(file).words
    file.write_bytes(table_bytes(words, board=0x12345678))
    refused(tool("load", "law", file), "it is made for another board")
    file.write_bytes(table_bytes(sealed(kinds.RULES.magic, [0] * 2045)))
    refused(tool("load", "law", file), "refused: ")  # 8208 bytes came through to be judged
    assert told(tool)["law"]["crc"] == crc and told(tool)["law"]["refusal"]
    file.write_bytes(table_bytes(words))
    refused(tool("load", "law", file, "--save"), "in use, but not stored for the next start")


def test_frames_that_get_lost(controller: Controller, tool, other_rules: Path) -> None:
    """One of the controller's 60: replies and flow control among them."""
    controller.start("--drop", "60")
    loaded(tool("load", "rules", other_rules, "--json"))


@pytest.mark.slow
def test_a_silent_controller(controller: Controller, tool, other_rules: Path) -> None:
    controller.start("--silent")
    for words in (["tables"], ["load", "rules", other_rules], ["revert", "law"]):
        refused(tool(*words), "no controller answers")
