"""libquiesce-dev: what is in it, and a project that finds it as its user's would."""

from pathlib import Path

import pytest
from conftest import ARCHITECTURES, BUILD, ROOT, Package, run, succeed

LIBRARIES = {"amd64": "x86_64-linux-gnu", "arm64": "aarch64-linux-gnu"}
MACHINES = {"amd64": "Advanced Micro Devices X86-64", "arm64": "AArch64"}


@pytest.fixture(scope="module", params=ARCHITECTURES)
def library(request: pytest.FixtureRequest) -> Package:
    (file,) = BUILD.glob(f"packages/libquiesce-dev_*_{request.param}.deb")
    return Package(request.param, file)


@pytest.fixture(scope="module")
def tree(library: Package, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Its files, unpacked."""
    folder = tmp_path_factory.mktemp(library.arch)
    succeed("dpkg-deb", "--extract", library.path, folder)
    return folder


def test_it_is_of_the_version_of_the_program(library: Package) -> None:
    (program,) = BUILD.glob(f"packages/quiesced_*_{library.arch}.deb")
    assert library.field("Version") == Package(library.arch, program).field("Version")
    assert library.field("Multi-Arch") == "same" and library.field("Section") == "libdevel"


def test_it_has_libraries_headers_and_the_messages(library: Package, tree: Path) -> None:
    names = {f"/{one.relative_to(tree)}" for one in tree.rglob("*") if not one.is_dir()}
    folder = f"/usr/lib/{LIBRARIES[library.arch]}"
    for name in ("libquiesce_core.a", "libquiesce_comm.a", "cmake/quiesce/quiesce-config.cmake"):
        assert f"{folder}/{name}" in names, sorted(names)
    for header in (ROOT / "firmware/include").glob("*.h"):
        assert any(name.endswith(f"/{header.name}") for name in names), header.name
    assert (tree / "usr/share/quiesce/quiesce.dbc").read_bytes() == (
        ROOT / "firmware/comm/quiesce.dbc"
    ).read_bytes()
    elf = succeed("readelf", "-h", tree / folder.lstrip("/") / "libquiesce_core.a")
    machines = {line.split(":")[1].strip() for line in elf.splitlines() if "Machine:" in line}
    assert machines == {MACHINES[library.arch]}


def test_no_file_names_a_folder_of_the_build(tree: Path) -> None:
    for file in tree.rglob("*"):
        if file.is_file() and not file.is_symlink():
            data = file.read_bytes()
            assert str(ROOT).encode() not in data and b"/tmp/" not in data, file


def test_lintian_finds_nothing(library: Package) -> None:
    result = run("lintian", "--allow-root", "--fail-on", "error,warning", library.path)
    assert result.returncode == 0, result.stdout + result.stderr
    assert result.stdout == ""


def test_a_project_finds_it_and_runs(library: Package, tree: Path, tmp_path: Path) -> None:
    """examples/embed/find_package, outside of the source tree; its exit code is its verdict."""
    project = tmp_path / "embed"
    succeed("cp", "-R", ROOT / "examples/embed", project)
    options = [f"-DCMAKE_PREFIX_PATH={tree}/usr", "-DCMAKE_BUILD_TYPE=Release"]
    if library.arch == "arm64":
        options += [
            f"-DCMAKE_TOOLCHAIN_FILE={ROOT}/cmake/aarch64-linux-gnu.cmake",
            "-DCMAKE_FIND_ROOT_PATH_MODE_PACKAGE=BOTH",
            f"-Dquiesce_DIR={tree}/usr/lib/{LIBRARIES[library.arch]}/cmake/quiesce",
        ]
    succeed("cmake", "-S", project / "find_package", "-B", tmp_path / "build", *options)
    succeed("cmake", "--build", tmp_path / "build")
    is_native = library.arch == "amd64"
    emulator = [] if is_native else ["qemu-aarch64-static", "-L", "/usr/aarch64-linux-gnu"]
    succeed(*emulator, tmp_path / "build/app")
