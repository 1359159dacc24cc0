"""The STM32F4's registers: read from a description, refused where that is not what was wanted."""

import hashlib
import importlib.util
import io
import shutil
import subprocess
import sys
import tarfile
import tomllib
from pathlib import Path
from types import ModuleType

import pytest
from conftest import ROOT

SCRIPT = "tools/gen/stm32f4_registers.py"
# As svd2rust writes: a block, and a register with a field of each kind.
BLOCK = """
impl RegisterBlock {
    ///0x04 - Status register
    #[inline(always)]
    pub const fn sr(&self) -> &SR {
        &self.sr
    }
}
"""
REGISTER = """
pub type OVR_R = crate::BitReader;
pub type OVR_W<'a, REG> = crate::BitWriter0C<'a, REG>;
pub type ERR_W<'a, REG> = crate::BitWriter1C<'a, REG>;
pub type RUN_W<'a, REG> = crate::BitWriter<'a, REG>;
pub type LEN_W<'a, REG> = crate::FieldWriter<'a, REG, 3>;
impl R {
    ///Bit 0 - Overrun
    #[inline(always)]
    pub fn ovr(&self) -> OVR_R {
        OVR_R::new((self.bits & 1) != 0)
    }
}
impl W {
    ///Bit 0 - Overrun
    #[inline(always)]
    pub fn ovr(&mut self) -> OVR_W<SRrs> {
        OVR_W::new(self, 0)
    }
    ///Bit 1 - Error
    #[inline(always)]
    pub fn err(&mut self) -> ERR_W<SRrs> {
        ERR_W::new(self, 1)
    }
    ///Bits 4:6 - Length
    #[inline(always)]
    pub fn len(&mut self) -> LEN_W<SRrs> {
        LEN_W::new(self, 4)
    }
}
impl crate::Resettable for SRrs {
    const RESET_VALUE: u32 = 0x1000_0002;
}
"""
MODULE = """
    USART9 = 77,
pub type USART9 = crate::Periph<usart9::RegisterBlock, 0x4001_1000>;
"""


def load_generator() -> ModuleType:
    spec = importlib.util.spec_from_file_location("stm32f4_registers", ROOT / SCRIPT)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


registers = load_generator()


def make_crate(path: Path) -> Path:
    files = {"mod.rs": MODULE, "usart9.rs": BLOCK, "usart9/sr.rs": REGISTER}
    with tarfile.open(path, "w:gz") as tar:
        for name, text in files.items():
            info = tarfile.TarInfo(f"made-1/src/chip/{name}")
            info.size = len(text)
            tar.addfile(info, io.BytesIO(text.encode()))
    return path


def crate(tmp_path: Path) -> object:
    return registers.Crate(make_crate(tmp_path / "made.crate"), "made-1", "chip")


def test_a_register_is_read_as_it_is_described(tmp_path: Path) -> None:
    made = crate(tmp_path)
    assert made.base("USART9") == 0x40011000
    assert made.interrupt("USART9") == 77
    rows = dict(registers.wanted_rows(made, {"name": "usart9", "registers": ["sr"]}))
    assert rows["sr"]["offset"] == 4 and rows["sr"]["reset"] == 0x10000002
    does = {name: sorted(field["does"]) for name, field in rows["sr"]["fields"].items()}
    assert does == {"ovr": ["0 clears", "readable"], "err": ["1 clears"], "len": ["writable"]}
    assert registers.mask(rows["sr"]["fields"]["len"]) == 0x70


def test_what_the_description_lacks_takes_the_place_of_what_it_says(tmp_path: Path) -> None:
    rows = dict(registers.wanted_rows(crate(tmp_path), {"name": "usart9", "registers": ["sr"]}))
    effect = {"register": "usart9.sr", "fields": ["len"], "what": "1 sets"}
    registers.with_effects(rows, "usart9", [effect])
    assert rows["sr"]["fields"]["len"]["does"] == ["readable", "1 sets"]
    with pytest.raises(registers.Refused, match="has no field none"):
        registers.with_effects(rows, "usart9", [{**effect, "fields": ["none"]}])


@pytest.mark.parametrize(
    ("block", "line"),
    [
        ({"name": "usart9", "registers": ["dr"]}, "usart9 has no register dr"),
        ({"name": "spi|i2c", "registers": ["sr"]}, "the crate has no block spi|i2c"),
    ],
)
def test_what_is_not_there_is_refused(tmp_path: Path, block: dict, line: str) -> None:
    with pytest.raises(registers.Refused) as refused:
        dict(registers.wanted_rows(crate(tmp_path), block))
    assert str(refused.value) == line
    with pytest.raises(registers.Refused, match="no SPI9"):
        crate(tmp_path).base("SPI9")


def run_in(folder: Path, *arguments: str | Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, folder / SCRIPT, *map(str, arguments)], capture_output=True, text=True
    )


@pytest.fixture
def tree(tmp_path: Path) -> Path:
    """What the generator reads and writes."""
    for name in (SCRIPT, registers.WANTED, registers.TABLE):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(ROOT / name, tmp_path / name)
    assert run_in(tmp_path).returncode == 0
    return tmp_path


def test_an_edited_header_is_seen(tree: Path) -> None:
    assert run_in(tree, "--check").returncode == 0
    header = tree / registers.HEADERS / "stm32f4_iwdg.h"
    header.write_text(header.read_text().replace("0xfffu", "0xffu"))
    checked = run_in(tree, "--check")
    assert checked.returncode == 1 and "stm32f4_iwdg.h" in checked.stdout


@pytest.mark.parametrize("bad", ["other wanted", "no TOML", "other crate", "no crate", "torn"])
def test_bad_sources_are_refused_with_one_line_and_change_nothing(tree: Path, bad: str) -> None:
    arguments: list[str | Path] = []
    if bad == "other wanted":
        (tree / registers.WANTED).write_text((tree / registers.WANTED).read_text() + "\n")
    elif bad == "no TOML":
        (tree / registers.TABLE).write_text("wanted = ")
    elif bad == "other crate":
        arguments = ["--crate", make_crate(tree / "made.crate")]
    elif bad == "no crate":
        arguments = ["--crate", tree / "none.crate"]
    else:  # the right hash of a file that is no archive
        torn = tree / "torn.crate"
        torn.write_bytes(b"torn")
        text = (tree / registers.WANTED).read_text()
        old = tomllib.loads(text)["sha256"]
        new = hashlib.sha256(b"torn").hexdigest()
        (tree / registers.WANTED).write_text(text.replace(old, new))
        arguments = ["--crate", torn]
    before = {path: path.read_bytes() for path in tree.rglob("*.[ch]")}
    result = run_in(tree, *arguments)
    assert result.returncode == 2, result.stderr
    assert len(result.stderr.splitlines()) == 1
    assert result.stderr.startswith("stm32f4_registers: ")
    assert before == {path: path.read_bytes() for path in tree.rglob("*.[ch]")}
