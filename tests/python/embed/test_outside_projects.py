"""Projects that are not ours with the library in them, and what they are refused."""

import json
import subprocess
from pathlib import Path

import pytest
from conftest import ROOT
from quiesce_benchmarks.install.outside import PROJECTS, build_image, install, run

QUICK = ("add_subdirectory", "cpp")
HEADERS = sorted(
    [*ROOT.glob("firmware/include/*.h"), *ROOT.glob("firmware/comm/*.h")],
    key=lambda header: header.name,
)
FOLDERS = [f"-I{ROOT / name}" for name in ("firmware/include", "firmware/comm")]
FOLDERS.append(f"-I{ROOT / 'firmware/comm/generated'}")
EXAMPLE = ROOT / "examples/embed/find_package"


@pytest.mark.parametrize(
    "name",
    [pytest.param(name, marks=() if name in QUICK else pytest.mark.slow) for name in PROJECTS],
)
def test_project_builds_with_the_library_in_it_and_runs(name: str, tmp_path: Path) -> None:
    PROJECTS[name](tmp_path)  # raises where it does not build, or exits with another code than 0


def configure(source: Path, folder: Path, **options: str | Path) -> str:
    """What CMake says when it refuses."""
    given = [f"-D{name}={value}" for name, value in options.items()]
    command = ["cmake", "-G", "Ninja", "-S", source, "-B", folder, *given]
    ended = subprocess.run(command, capture_output=True, text=True, timeout=120)
    assert ended.returncode != 0
    return " ".join(ended.stderr.split())


@pytest.mark.parametrize(
    ("option", "said"),
    [
        ("QUIESCE_LAWS", "QUIESCE_LAWS: no law 'fuzy'; there are"),
        ("QUIESCE_TRACKERS", "QUIESCE_TRACKERS: no tracker 'fuzy'; there are"),
        ("QUIESCE_ESTIMATORS", "QUIESCE_ESTIMATORS: no estimator 'fuzy'"),
        ("QUIESCE_PLANT", "QUIESCE_PLANT is fuzy; no plant_rules.h"),
    ],
)
def test_unknown_choice_is_refused_by_name(option: str, said: str, tmp_path: Path) -> None:
    assert said in configure(ROOT, tmp_path, QUIESCE_DEVELOP="OFF", **{option: "fuzy"})


@pytest.mark.slow
def test_another_minor_version_is_not_found(tmp_path: Path) -> None:
    prefix = install(tmp_path)
    project = tmp_path / "other"
    project.mkdir()
    text = (EXAMPLE / "CMakeLists.txt").read_text()
    (project / "CMakeLists.txt").write_text(text.replace("quiesce 0.1", "quiesce 0.2"))
    said = configure(project, tmp_path / "b", CMAKE_PREFIX_PATH=prefix)
    assert "version: 0.1.0" in said


@pytest.mark.slow
def test_a_law_that_is_left_out_costs_no_flash(tmp_path: Path) -> None:
    symbols = run("arm-none-eabi-nm", build_image(tmp_path, QUIESCE_LAWS="fuzzy"))
    assert "law_fuzzy" in symbols
    assert "law_phase" not in symbols


@pytest.mark.parametrize("language", ["c -std=c11", "c++ -std=c++11"])
def test_every_public_header_stands_alone(language: str, tmp_path: Path) -> None:
    source = tmp_path / "all"
    for header in HEADERS:
        source.write_text(f'#include "{header.name}"\nextern int unused;\n')
        run(
            "gcc", "-x", *language.split(), "-Wall", "-Wextra", "-Wpedantic", "-Werror",
            *FOLDERS, "-fsyntax-only", source,
        )  # fmt: skip


def test_cpp_links_every_public_function(tmp_path: Path) -> None:
    """None of them has lost its extern "C"."""
    source = tmp_path / "all.cpp"
    source.write_text("".join(f'#include "{header.name}"\n' for header in HEADERS))
    run("g++", "-std=c++11", *FOLDERS, "-O0", "-c", source, "-o", tmp_path / "all.o")
    for header in HEADERS:
        text = header.read_text()
        if ");\n" in text:
            assert 'extern "C"' in text, header.name


def test_platformio_is_told_the_sources_the_flags_and_the_version(tmp_path: Path) -> None:
    """What library.json says makes the library, compiled here without PlatformIO."""
    told = json.loads((ROOT / "library.json").read_text())
    build = told["build"]
    sources = {
        file
        for rule in build["srcFilter"]
        if rule.startswith("+")
        for file in ROOT.glob(f"{build['srcDir']}/{rule[2:-1]}")
    }
    sources -= set(ROOT.glob("firmware/comm/*"))
    folders = {f"-I{file.parent.relative_to(ROOT)}" for file in sources}
    assert folders <= {*build["flags"], "-Ifirmware/board"}
    flags = [*build["flags"], f"-I{build['includeDir']}", "-std=c11", "-O0"]
    app = ROOT / "examples/embed/app.c"
    program = tmp_path / "app"
    run("gcc", *flags, "-o", program, app, *sorted(sources), folder=ROOT)
    run(program)
    assert told["version"] == version()


def version() -> str:
    header = (ROOT / "firmware/include/quiesce_version.h").read_text()
    parts = [line.split()[2] for line in header.splitlines() if "QUIESCE_VERSION_M" in line]
    parts += [line.split()[2] for line in header.splitlines() if "QUIESCE_VERSION_P" in line]
    return ".".join(parts)
