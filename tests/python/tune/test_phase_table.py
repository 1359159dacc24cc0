"""Law files of the phase law: read, written, compiled to words, refused."""

import re
import struct
import zlib
from dataclasses import astuple

import pytest
from conftest import ROOT
from quiesce.base.errors import UsageError
from quiesce.table.kinds import PULSES
from quiesce.table.words import sealed
from quiesce.tune.phase_table import (
    SETTINGS,
    PhaseLaw,
    Point,
    interpolated,
    law_text,
    read_law,
)
from quiesce.tune.phase_words import POINT_WORDS, described_pulses, law_of_words, law_words

LAW_FILE = ROOT / "firmware/plants/squeeze_2012/pulses.phase.toml"
POINTS = (Point(4.0, 170.0, 80.0, 5000, 0, 0.5), Point(6.0, 10.0, 100.0, 4000, 200, 1.0))
LAW = PhaseLaw("small", "by hand", 5000, {name: POINTS for name in SETTINGS})


@pytest.fixture
def law_file(tmp_path):
    file = tmp_path / "small.phase.toml"
    file.write_text(law_text(LAW), encoding="utf-8")
    return file


def test_law_reads_as_it_was_written(law_file):
    assert read_law(law_file) == LAW


def test_words_have_the_layout_that_the_firmware_reads():
    words = law_words(LAW)
    assert words[0] == int.from_bytes(b"QPH1", "little")
    assert words[1] == zlib.crc32(struct.pack(f"<{len(words) - 2}I", *words[2:]))
    assert words[2] == len(words) == 5 + POINT_WORDS * 4
    assert words[3] == 2 | 2 << 16
    assert words[4] == 5000
    assert words[5] == 4000 | 5000 << 16
    assert words[6] == round(170 / 180 * 65536) | round(80 / 180 * 65536) << 16
    assert words[7] == 0 | 128 << 16
    assert words[7 + POINT_WORDS] == 200 | 256 << 16


def test_words_read_as_they_were_written():
    again = law_of_words(law_words(LAW))
    assert again.unlock_current_mA == LAW.unlock_current_mA
    for name in SETTINGS:
        for one, other in zip(again.settings[name], LAW.settings[name], strict=True):
            assert astuple(one) == pytest.approx(astuple(other), abs=0.002)
    assert law_words(again) == law_words(LAW)
    assert "10.00 deg  100.00 deg  4 A  0.2 A" in re.sub(" {2,}", "  ", described_pulses(again))


@pytest.mark.parametrize("sizes", [1 | 3 << 16, 65 | 2 << 16, 2 | 3 << 16, 2 | 2 << 16])
def test_words_of_other_sizes_are_refused(sizes):
    words = [sizes, 5000, *law_words(LAW)[5:-1]]
    with pytest.raises(ValueError, match="a setting has 2 .. 64|ends before all of its parts"):
        law_of_words(sealed(PULSES.magic, words))


def test_full_width_is_the_largest_word():
    wide = PhaseLaw("w", "s", 0, {n: (Point(1, 0, 180.0, 1, 0), POINTS[1]) for n in SETTINGS})
    assert law_words(wide)[6] >> 16 == 65535


def test_centre_goes_the_shorter_way_round():
    middle = interpolated(POINTS, 5.0)
    assert middle.centre_deg == pytest.approx(0.0)
    assert (middle.width_deg, middle.level_mA, middle.floor_mA) == (90.0, 4500, 100)
    assert interpolated(POINTS, 1.0) == POINTS[0]
    assert interpolated(POINTS, 9.0) == POINTS[1]


@pytest.mark.parametrize(
    ("find", "put", "complaint"),
    [
        (
            "freq_Hz = 6.000",
            "freq_Hz = 4.000",
            r"points\[1\].freq_Hz: 4 Hz after 4 Hz; allowed: ris",
        ),
        ("width_deg = 80.00", "width_deg = 181", r"width_deg: 181; allowed: 0 .. 180 degrees"),
        ("level_mA = 5000", "level_mA = 5000.5", r"level_mA: 5000.5; allowed: an integer, 0"),
        ("floor_mA = 200", "floor_mA = 4001", r"floor_mA: 4001; allowed: 0 .. 4000 mA"),
        ("centre_deg = 10.00", "centre = 10", r"centre: unknown key; allowed: freq_Hz"),
        ("centre_deg = 10.00, ", "", r"centre_deg: missing"),
        ('"balanced"', '"other"', r"setting\[1\].name: 'other'; allowed: 'balanced'"),
        ("version = 1", "version = 2", r"version: 2; allowed: 1"),
        ("unlock_current_mA = 5000", "unlock_current_mA = -1", r"unlock_current_mA: -1; allowed"),
        ("points = [", "points = 3\nx = [", r"x: unknown key"),
        ('schema = "', "schema = ", r"not a TOML file"),
    ],
)
def test_mistakes_are_named(law_file, find, put, complaint):
    text = law_file.read_text()
    assert find in text
    law_file.write_text(text.replace(find, put))
    with pytest.raises(UsageError, match=complaint) as caught:
        read_law(law_file)
    assert str(caught.value).startswith(str(law_file))


def test_missing_file_is_named(tmp_path):
    with pytest.raises(UsageError, match="name a law file"):
        read_law(tmp_path / "none.toml")


def test_shipped_law_is_valid_and_small():
    law = read_law(LAW_FILE)
    assert law.settings["balanced"][0].freq_Hz <= 4.0
    assert law.settings["balanced"][-1].freq_Hz >= 22.0
    assert 4 * len(law_words(law)) < 2048
