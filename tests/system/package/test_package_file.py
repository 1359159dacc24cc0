"""The package files: what is in them, how the program was built, what the checkers say."""

import re
from pathlib import Path

import pytest
from conftest import BUILD, ROOT, Package, run, succeed

FILES = """
/etc/quiesced/quiesced.toml 644
/lib/systemd/system/quiesced.service 644
/lib/udev/rules.d/60-quiesced.rules 644
/usr/lib/sysusers.d/quiesced.conf 644
/usr/sbin/quiesced 755
/usr/share/doc/quiesced/changelog.gz 644
/usr/share/doc/quiesced/copyright 644
/usr/share/doc/quiesced/examples/80-can0.network 644
/usr/share/man/man8/quiesced.8.gz 644
"""
MACHINES = {"amd64": "Advanced Micro Devices X86-64", "arm64": "AArch64"}
# systemd-analyze's exposure in tenths: what talks to hardware in real time cannot reach 0.
MOST_EXPOSURE = 25


def header_version() -> str:
    header = (ROOT / "firmware/include/quiesce_version.h").read_text()
    return ".".join(
        re.search(rf"QUIESCE_VERSION_{part} (\d+)", header)[1]
        for part in ("MAJOR", "MINOR", "PATCH")
    )


def test_control_fields(package: Package) -> None:
    assert package.field("Package") == "quiesced"
    assert package.field("Architecture") == package.arch
    assert package.field("Version") == header_version()
    depends = package.field("Depends")
    for library in ("libc6", "libgpiod2", "libstdc++6"):
        assert re.search(rf"\b{re.escape(library)} \(>= ", depends), depends
    assert "systemd-sysusers" in depends


def test_files_and_modes(contents: Path) -> None:
    found = [
        f"/{path.relative_to(contents)} {path.stat().st_mode & 0o777:o}"
        for path in sorted(contents.rglob("*"))
        if not path.is_dir()
    ]
    assert found == sorted(FILES.split("\n")[1:-1])


def test_every_file_belongs_to_root(package: Package) -> None:
    for line in succeed("dpkg-deb", "--contents", package.path).splitlines():
        assert line.split()[1] == "root/root", line


def test_configuration_is_left_to_the_administrator(package: Package, tmp_path: Path) -> None:
    succeed("dpkg-deb", "--control", package.path, tmp_path / "control")
    names = (tmp_path / "control/conffiles").read_text().split()
    assert names == ["/etc/quiesced/quiesced.toml"]


def test_program_is_hardened_and_stripped(package: Package, contents: Path) -> None:
    elf = succeed("readelf", "-W", "-h", "-l", "-d", "-S", contents / "usr/sbin/quiesced")
    assert f"Machine:                           {MACHINES[package.arch]}" in elf
    assert "GNU_RELRO" in elf
    assert re.search(r"FLAGS_1.*NOW.*PIE", elf), "not bound at start or not position-independent"
    assert re.search(r"GNU_STACK .* RW +0x", elf), "executable stack"
    assert ".symtab" not in elf and ".debug_info" not in elf
    assert "RPATH" not in elf and "RUNPATH" not in elf
    assert "Shared library: [libgpiod.so.2]" in elf
    symbols = succeed("readelf", "-W", "--dyn-syms", contents / "usr/sbin/quiesced")
    assert "__stack_chk_fail" in symbols
    assert re.search(r"__\w+_chk@", symbols), "no fortified call"


def test_program_names_no_folder_of_the_build(contents: Path) -> None:
    program = (contents / "usr/sbin/quiesced").read_bytes()
    assert str(ROOT).encode() not in program
    assert b"/tmp/" not in program


def test_lintian_finds_nothing(package: Package) -> None:
    result = run("lintian", "--allow-root", "--fail-on", "error,warning", package.path)
    assert result.returncode == 0, result.stdout + result.stderr
    assert result.stdout == ""


def test_manual_page_has_no_mistakes_and_every_option(contents: Path) -> None:
    page = contents / "usr/share/man/man8/quiesced.8.gz"
    result = run("man", "--warnings", "--encoding=UTF-8", "--local-file", page)
    assert result.returncode == 0
    assert result.stderr == ""
    usage = (ROOT / "targets/linux/quiesced/options.cpp").read_text()
    for option in set(re.findall(r"--[a-z][a-z-]+", usage)):
        assert option in result.stdout, f"{option} is not in the manual page"


def test_service_never_gives_up(contents: Path) -> None:
    unit = (contents / "lib/systemd/system/quiesced.service").read_text().splitlines()
    for line in ("StartLimitIntervalSec=0", "Restart=on-failure", "RestartSec=2"):
        assert line in unit
    assert unit.index("StartLimitIntervalSec=0") < unit.index("[Service]")
    assert not any(line.startswith("StartLimitBurst") for line in unit)


def test_service_is_confined(contents: Path) -> None:
    unit = contents / "lib/systemd/system/quiesced.service"
    result = run(
        "systemd-analyze", "security", "--offline=yes", f"--threshold={MOST_EXPOSURE}", unit
    )
    assert result.returncode == 0, result.stdout + result.stderr


def test_udev_rules_are_well_formed(contents: Path) -> None:
    keys = r"(ACTION|SUBSYSTEM|KERNEL)==|(GROUP|MODE|GOTO|LABEL)=|RUN\+="
    rules = (contents / "lib/udev/rules.d/60-quiesced.rules").read_text().splitlines()
    for line in rules:
        if not line.startswith("#"):
            for part in re.split(r", (?=[A-Z]+[=+])", line):
                assert re.fullmatch(rf'({keys})"[^"]+"', part), part


def test_versions_in_the_log_of_changes_and_the_manual_page_agree(package: Package) -> None:
    page = (ROOT / "targets/linux/packaging/debian/quiesced.8").read_text().splitlines()[0]
    assert f'"Quiesce {header_version()}"' in page


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["riscv64"], "unknown argument 'riscv64'"),
        (["--out"], "--out needs a folder"),
        (["--out", ""], "--out needs a folder"),
        (["--roots"], "unknown argument '--roots'"),
    ],
)
def test_wrong_arguments_are_refused(arguments: list[str], words: str) -> None:
    result = run(ROOT / "tools/package", *arguments)
    assert result.returncode == 2
    assert result.stdout == ""
    assert len(result.stderr.splitlines()) == 1, result.stderr
    assert words in result.stderr


def test_same_sources_give_the_same_package(tmp_path: Path) -> None:
    """For one architecture: the other's differs in the compiler only, and it takes a build."""
    (first,) = BUILD.glob("packages/quiesced_*_amd64.deb")
    out = tmp_path / "two words"
    succeed(
        "sh", "-c", 'umask 077; exec "$@"', "sh",
        ROOT / "tools/package", "--out", out, "amd64",
        env={"PATH": "/usr/sbin:/usr/bin:/sbin:/bin", "TZ": "Asia/Kathmandu", "LC_ALL": "C"},
    )  # fmt: skip
    assert (out / "packages" / first.name).read_bytes() == first.read_bytes()
