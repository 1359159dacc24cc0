"""The law's table as the page shows it: the surface of rules, pulses; of others no picture."""

from collections.abc import Iterator

import numpy as np
import pytest
from conftest import ROOT
from live_page import Page
from quiesce.live.law_view import SIDE, view_of
from quiesce.loading.sources import table_of
from quiesce.rules.engine.engine import TableEngine
from quiesce.table.file import table_bytes

PLAIN = ROOT / "firmware/plants/squeeze_2012/rules.fcl"
SMOOTH = ROOT / "tests/unit/firmware/systems"
PULSES = ROOT / "firmware/plants/squeeze_2012/pulses.phase.toml"


def test_the_surface_of_rules_is_what_the_firmware_answers() -> None:
    words = table_of("rules", PLAIN).words
    view = view_of(table_bytes(words))
    surface = view["surface"]
    assert view["kind"] == "rules" and len(surface["freq_Hz"]) == SIDE
    assert np.shape(surface["current_A"]) == (SIDE, SIDE)
    freq, accel = surface["freq_Hz"], surface["accel_m_s2"]
    assert min(freq) >= 0 and max(freq) > 15 and max(accel) > 0.3
    engine = TableEngine(words)
    for i, j in ((0, 0), (10, 30), (SIDE - 1, SIDE - 1), (25, 25)):
        point = [np.array([round(1e6 * one)], np.int32) for one in (freq[i], accel[j])]
        wanted_A = 1e-3 * engine.evaluate(point)[0][0, 0]
        assert surface["current_A"][j][i] == pytest.approx(wanted_A, abs=0.02)
    assert np.ptp(surface["current_A"]) > 1.0


def test_pulses_are_rows_of_their_settings() -> None:
    view = view_of(table_bytes(table_of("pulses", PULSES).words))
    settings = view["pulses"]["settings"]
    assert set(settings) == {"displacement", "balanced"}
    for rows in settings.values():
        freq_Hz, centre_deg, width_deg, level_A = np.array(rows).T
        assert np.all(np.diff(freq_Hz) > 0)
        assert np.all((centre_deg >= 0) & (centre_deg <= 180) & (width_deg <= 180))
        assert 0 < level_A.max() <= 5


def test_of_other_kinds_there_is_no_picture() -> None:
    words = [0x314E4C51, 0, 0, 0, 0]
    assert view_of(table_bytes(words)) == {"kind": "linear", "crc": "00000000"}


@pytest.fixture(scope="module")
def page(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Page]:
    page = Page(tmp_path_factory.mktemp("law"), "--sim", "--law", "fuzzy")
    yield page
    assert page.end() == 0


def test_all_viewers_see_what_one_has_fetched(page: Page) -> None:
    crc = f"{table_of('rules', PLAIN).crc:08x}"
    with page.viewer() as viewer, page.viewer() as other:
        viewer.until("parameters", lambda one: one["values"])
        viewer.ask("law")
        assert viewer.note() == {"is_ok": False, "text": "take control first", "of": "law"}
        viewer.ask("take")
        viewer.ask("law")
        said = viewer.note()
        assert said["is_ok"], said["text"]
        assert said["text"] == f"rules {crc} is shown"
        assert other.until("law")["crc"] == crc
        with page.viewer() as late:
            assert len(late.until("law")["surface"]["freq_Hz"]) == SIDE
        viewer.ask("release")


def test_the_point_at_which_it_works_is_told(page: Page) -> None:
    with page.viewer() as viewer:
        now = viewer.until("state", lambda state: state["controller"]["freq_Hz"])["controller"]
    assert now["freq_Hz"] > 1 and now["rms_m_s2"] > 0 and now["freq_is_valid"]
