"""Fourth boot: `quiesce can load` sends a table through the guest's kernel to the controller, which
stores it, is killed, and uses it again; a damaged record is told and not used."""

from quiesce_vm.boots import TablesRun

SAVED = "saved: the law's table"


def law(tables: dict) -> dict:
    return tables["roads"][0]


def test_loaded_table_is_in_use_and_stored(tables: TablesRun) -> None:
    assert (tables.loaded["is_in_use"], tables.loaded["is_saved"]) == (True, True)
    before, after = law(tables.before), law(tables.after)
    assert (before["source"], before["stored_crc"], before["writes"]) == ("ships", None, 0)
    assert before["crc"] != tables.loaded["crc"]
    assert (after["source"], after["writes"], after["refusal"]) == ("loaded", 1, None)
    assert after["crc"] == after["stored_crc"] == tables.loaded["crc"]
    assert SAVED in tables.results["loaded"]["said"]


def test_stored_table_outlives_a_kill(tables: TablesRun) -> None:
    assert tables.results["loaded"]["code"] == 128 + 9
    found = law(tables.restarted)
    assert (found["source"], found["writes"]) == ("stored", 1)
    assert found["crc"] == found["stored_crc"] == tables.loaded["crc"]
    assert tables.results["restarted"]["code"] == 0
    assert f"CRC {tables.loaded['crc']} (stored)" in tables.results["restarted"]["said"]


def test_fetched_file_is_the_one_that_was_loaded(tables: TablesRun) -> None:
    assert tables.fetched["crc"] == tables.loaded["crc"]
    assert tables.fetched["words"] == tables.loaded["words"]


def test_damaged_record_is_told_and_what_ships_is_used(tables: TablesRun) -> None:
    found = law(tables.damaged)
    assert (found["crc"], found["source"]) == (law(tables.before)["crc"], "ships")
    assert found["stored_crc"] is None
    said = tables.results["damaged"]["said"]
    assert "the law's table as stored is not used: " in said
    assert "its checksum is wrong" in said
