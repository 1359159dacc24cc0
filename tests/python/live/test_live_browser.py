"""The page of `quiesce live` in Chromium, beside a real controller."""

import re
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from can_bus import Controller, build_peer
from conftest import ROOT
from live_page import Page, pull
from quiesce_benchmarks.live.browser import Browser, opened
from quiesce_benchmarks.live.rig import PATIENCE_S, Network

pytestmark = pytest.mark.slow
SERIES = 8
SERIOUS = ("serious", "critical")


@pytest.fixture(scope="module")
def peer(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return build_peer(tmp_path_factory.mktemp("live_peer"))


@pytest.fixture
def controller(peer: Path, tmp_path: Path) -> Iterator[Controller]:
    one = Controller(peer, tmp_path)
    one.start()
    yield one
    one.stop()


@pytest.fixture
def page(controller: Controller, tmp_path: Path) -> Iterator[Page]:
    one = Page(tmp_path, "--bus", controller.bus, "--raw")
    yield one
    one.end()


def until(browser: Browser, accept: Callable[[dict[str, Any]], bool]) -> dict[str, Any]:
    """What the page says, once it is accepted."""
    end_s = time.monotonic() + PATIENCE_S
    while time.monotonic() < end_s:
        said = browser.do("said")
        if accept(said):
            assert said["is_enabled"] and not said["errors"]
            return said
        time.sleep(0.05)
    raise AssertionError(f"the page says {said}")


def text(browser: Browser, selector: str, accept: Callable[[str], bool]) -> str:
    """Of that part of the page, once it is accepted."""
    end_s = time.monotonic() + PATIENCE_S
    while time.monotonic() < end_s:
        said = browser.do("text", selector)
        assert not said["errors"]
        if accept(said["text"]):
            return said["text"]
        time.sleep(0.05)
    raise AssertionError(f"{selector} says {said['text']}")


def test_every_sample_of_eight_signals_is_drawn(controller: Controller, tmp_path: Path) -> None:
    network = Network(controller.path)
    page = Page(tmp_path, *network.options, "--raw")
    with opened(page.address) as browser:
        found = browser.do("draw", 5)
    assert len(found["drawn"]) == SERIES and not found["errors"]
    assert found["lost"] == 0
    assert min(found["drawn"]) > 1000 and sum(found["ages_ms"]) == sum(found["drawn"])
    assert max(found["undrawn"]) <= 500  # what came since the last frame
    assert page.end() == 0
    network.end()


@pytest.mark.parametrize(
    ("law", "words"),
    [("fuzzy", r"Darkest: 5 A\. At \d+\.\d\d Hz and \S+ m/s2 RMS it says \S+ A"),
     ("phase", r"Without a lock: 5 A\. At \d+\.\d\d Hz: \S+ A for \d+ degrees around \d+")],
)  # fmt: skip
def test_the_law_s_table_is_drawn_with_the_point_at_which_it_works(
    tmp_path: Path, law: str, words: str
) -> None:
    page = Page(tmp_path, "--sim", "--law", law)
    with opened(page.address) as browser:
        text(browser, "#facts", lambda said: "RUN" in said)
        browser.do("press", "#take")
        text(browser, "#holder", lambda said: "You hold control" in said)
        browser.do("press", "#law-fetch")
        text(browser, "#law-here", lambda said: re.search(words, said) is not None)
        assert browser.do("painted", "#law-picture") > (20 if law == "fuzzy" else 2)
        assert [one for one in browser.do("axe") if one[0] in SERIOUS] == []
    assert page.end() == 0


def test_the_guided_session_is_led_on_the_page(tmp_path: Path) -> None:
    page = Page(tmp_path, "--sim", "--commission", "rig", "--first-mode", "11.5", "--quick")
    with opened(page.address) as browser:
        text(browser, "#guide-steps", lambda said: "wiring and polarity to do" in said)
        browser.do("press", "#take")
        text(browser, "#holder", lambda said: "You hold control" in said)
        browser.do("press", "#guide-one")
        browser.do("press", "#guide-go")
        text(browser, "#guide-steps", lambda said: "wiring and polarity under way" in said)
        assert [one for one in browser.do("axe") if one[0] in SERIOUS] == []
        text(browser, "#guide-steps", lambda said: "1000 mA flow" in said)
        text(browser, "#guide-ended", lambda said: said == "done")
        text(browser, "#guide-go", lambda said: said == "Go on")
        browser.do("press", "#guide-go")
        text(browser, "#guide-says", lambda said: "2/9" in said)
        browser.do("press", "#guide-leave")
        text(browser, "#guide-ended", lambda said: "goes on with the step" in said)
    assert page.end() == 0


@pytest.mark.parametrize("way", ["click", "key"])
def test_stop_is_confirmed_on_the_page(page: Page, way: str) -> None:
    with opened(page.address) as browser, page.viewer() as viewer:
        viewer.until("state", lambda state: state["controller"]["state"] == "RUN")
        browser.do(way)
        viewer.until("state", lambda state: state["controller"]["fault"] == "ESTOP")
        until(browser, lambda said: "Stopped" in said["stop"])


def test_stop_is_tried_again_while_the_server_is_away(controller: Controller, page: Page) -> None:
    with opened(page.address) as browser:
        until(browser, lambda said: "newest sample" in said["bus"])
        browser.do("offline")
        page.end()
        until(browser, lambda said: "NO CONNECTION" in said["bus"] or "NOTHING" in said["bus"])
        browser.do("click")
        until(browser, lambda said: "STOP NOT SENT" in said["stop"])
        again = Page(
            controller.path.parent, "--bus", controller.bus, "--port", str(page.port)
        )  # the last --port counts
        browser.do("online")
        until(browser, lambda said: "Stopped" in said["stop"])
        with again.viewer() as viewer:
            viewer.until("state", lambda state: state["controller"]["fault"] == "ESTOP")
        assert again.end() == 0


def test_loss_of_the_bus_is_shown_and_stop_waits_for_it(controller: Controller, page: Page) -> None:
    with opened(page.address) as browser:
        until(browser, lambda said: "newest sample" in said["bus"])
        pull(controller)
        until(browser, lambda said: "BUS LOST" in said["bus"])
        browser.do("click")
        until(browser, lambda said: "STOP NOT CONFIRMED (not sent" in said["stop"])
        controller.start()
        until(browser, lambda said: "Stopped" in said["stop"])


@pytest.mark.parametrize("options", [(), ("--size", "390x844", "--dark")])
def test_nothing_serious_for_axe(page: Page, options: tuple[str, ...]) -> None:
    with opened(page.address, *options) as browser:
        until(browser, lambda said: "newest sample" in said["bus"])
        assert [one for one in browser.do("axe") if one[0] in SERIOUS] == []
        browser.do("click")
        until(browser, lambda said: "Stopped" in said["stop"])
        assert [one for one in browser.do("axe") if one[0] in SERIOUS] == []


def test_a_recording_is_made_marked_and_fetched(page: Page) -> None:
    with opened(page.address) as browser:
        browser.do("press", "#take")
        browser.do("choose", "#record-format", "csv")
        browser.do("press", "#record")
        text(browser, "#record-now", lambda said: said.startswith("Recording quiesce_"))
        browser.do("fill", "#record-text", "the pump starts")
        browser.do("press", "#record-mark")
        text(browser, "#record-now", lambda said: said.endswith(", 1 marker"))
        browser.do("press", "#record-end")
        text(browser, "#record-files", lambda said: ".csv.markers.csv" in said)
        markers, frames = (
            browser.do("fetch", f"#record-files li:nth-child({number}) a") for number in (1, 2)
        )
        assert markers["status"] == frames["status"] == 200
        assert frames["length"] > 10 * markers["length"] > 0


def test_a_trigger_that_is_none_is_not_sent(page: Page) -> None:
    with opened(page.address) as browser:
        browser.do("press", "#take")
        browser.do("fill", "#record-before", "31")  # beyond what is kept
        browser.do("press", "#record")
        browser.do("fill", "#record-before", "1")
        browser.do("choose", "#record-on", "fault")
        browser.do("press", "#record")
        text(browser, "#record-now", lambda said: said == "Waiting for the trigger.")
        browser.do("press", "#record-end")
        text(browser, "#record-now", lambda said: said == "Nothing is recorded.")


@pytest.mark.parametrize("options", [(), ("--size", "390x844", "--dark")])
def test_spectrum_and_waterfall_are_drawn(page: Page, options: tuple[str, ...]) -> None:
    with opened(page.address, *options) as browser:
        peak = text(browser, "#spectrum-peak", lambda said: "the controller reports" in said)
        assert " m/s2 RMS" in peak
        browser.do("choose", "#spectrum-length", "1")
        browser.do("choose", "#spectrum-averages", "1")
        text(browser, "#spectrum-said", lambda said: "one window of 1.0" in said)
        end_s = time.monotonic() + PATIENCE_S
        while browser.do("painted", "#spectrum-waterfall") < 20:
            assert time.monotonic() < end_s
            time.sleep(0.05)


def test_revert_says_to_what(page: Page) -> None:
    with opened(page.address) as browser:
        text(browser, "#revert", lambda said: said == "Revert to the server's start")
        browser.do("press", "#take")
        browser.do("press", "#save")
        text(browser, "#revert", lambda said: said == "Revert to the last save")


def test_the_panel_moves_the_rig(tmp_path: Path) -> None:
    rig = Page(tmp_path, "--sim")
    with opened(rig.address) as browser:
        browser.do("press", "#take")
        text(browser, "#rig-control", lambda said: said == "Switch control off")
        browser.do("press", "#rig-control")
        text(browser, "#rig-control", lambda said: said == "Switch control on")
        text(browser, "#facts dd", lambda said: said == "IDLE")
        browser.do("choose", "#rig-law", "constant")
        text(browser, "#said", lambda said: said == "1 changed and read back")
        browser.do("fill", "#rig-freq_Hz+input", "12.5")
        text(browser, "#rig-panel", lambda said: "at 12.50 Hz" in said)
        browser.do("press", "#rig-panel button[data-kind=estop]")
        text(browser, "#facts dd:nth-of-type(2)", lambda said: said == "ESTOP")
        browser.do("press", "#rig-control")
        text(browser, "#rig-control", lambda said: said == "Switch control off")
    assert rig.end() == 0


def test_the_panel_moves_a_rig_whose_controller_is_an_image(tmp_path: Path) -> None:
    rig = Page(tmp_path, "--sim", "--target", "mps2")
    with opened(rig.address) as browser:
        text(browser, "#facts", lambda said: "RUN" in said)
        browser.do("press", "#take")
        browser.do("press", "#rig-control")
        text(browser, "#rig-control", lambda said: said == "Switch control on")
        text(browser, "#facts dd", lambda said: said == "IDLE")
        browser.do("fill", "#rig-freq_Hz+input", "12.5")
        text(browser, "#rig-panel", lambda said: "at 12.50 Hz" in said)
        browser.do("press", "#rig-control")
        text(browser, "#facts", lambda said: "RUN" in said)
        browser.do("click")
        until(browser, lambda said: "Stopped" in said["stop"])
    assert rig.end() == 0


RULES = ROOT / "sim_hil/data/rules/squeeze_2012_published.fcl"


def test_a_table_is_loaded_from_the_page_and_one_that_is_none_is_refused(
    page: Page, tmp_path: Path
) -> None:
    wrong = tmp_path / "wrong.fcl"
    wrong.write_text("FUNCTION_BLOCK of nothing")
    with opened(page.address) as browser:
        until(browser, lambda said: "newest sample" in said["bus"])
        browser.do("press", "#take")
        browser.do("attach", "#table-file", wrong)
        browser.do("press", "#table-load")
        said = text(browser, "#table-said", lambda said: "wrong.fcl:" in said)
        assert "\n" not in said and "quiesce-" not in said
        browser.do("attach", "#table-file", RULES)
        browser.do("press", "#table-load")
        said = text(browser, "#table-said", lambda said: "is in use" in said)
        assert said.startswith("squeeze_2012_published.fcl: rules ")
