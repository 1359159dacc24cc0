"""Set-up of the virtual machine: what it fetches, what it keeps, what it refuses. No network."""

import hashlib
import shutil
import subprocess
from pathlib import Path

import pytest
from test_setup_scripts import ROOT, Clone, assert_one_line

SETUP = "common images"
VM = Path("tests/system/vm")
EXTRA = ("find", "head", "id", "sed", "sort", "dpkg-deb", "tar", "xz")


@pytest.fixture
def scripts(tmp_path: Path) -> Clone:
    clone = Clone(tmp_path)
    (clone.root / VM).mkdir(parents=True)
    for name in ("build_images", "images.sh"):
        shutil.copy(ROOT / VM / name, clone.root / VM / name)
    for name in EXTRA:
        if not (clone.bin / name).exists():
            (clone.bin / name).symlink_to(shutil.which(name))
    clone.fake("apt-get", "exit 100")
    return clone


def fill_cache(clone: Clone, text: str = "a package") -> Path:
    """A cache that holds one package and a list that knows it."""
    cache = clone.root / "build/vm/cache"
    cache.mkdir(parents=True)
    (cache / "one_1.0_arm64.deb").write_text("a package")
    digest = hashlib.sha256(text.encode()).hexdigest()
    (cache / "libs.sha256").write_text(f"# one\n{digest}  one_1.0_arm64.deb\n")
    return cache


@pytest.mark.parametrize(
    ("arguments", "words"),
    [(["everything"], ["everything", "root, kernel or all"]), (["root", "all"], ["one argument"])],
)
def test_unknown_argument_is_refused(scripts: Clone, arguments, words) -> None:
    assert_one_line(scripts.run(str(scripts.root / VM / "build_images"), *arguments), *words)
    assert not (scripts.root / "build").exists()


def test_help_needs_nothing_installed(scripts: Clone) -> None:
    result = scripts.run(str(scripts.root / VM / "build_images"), "--help")
    assert result.returncode == 0
    assert result.stdout.startswith("usage:")
    assert not (scripts.root / "build").exists()


def test_full_cache_needs_no_network(scripts: Clone) -> None:
    cache = fill_cache(scripts)
    result = scripts.function(SETUP, "vm_fetch libs one && vm_files libs")
    assert (result.returncode, result.stdout) == (0, f"{cache}/one_1.0_arm64.deb\n")
    assert scripts.calls("apt-get") == []


def test_cache_elsewhere_is_used(scripts: Clone, tmp_path: Path) -> None:
    fill_cache(scripts).rename(tmp_path / "kept")
    code = "vm_fetch libs one && vm_files libs"
    result = scripts.function(SETUP, code, QUIESCE_VM_CACHE=str(tmp_path / "kept"))
    assert (result.returncode, result.stdout) == (0, f"{tmp_path}/kept/one_1.0_arm64.deb\n")


@pytest.mark.parametrize("wanted", ["one", "one two"])
def test_without_network_a_cache_that_lacks_something_is_told(scripts: Clone, wanted: str) -> None:
    fill_cache(scripts, text="another package" if wanted == "one" else "a package")
    result = scripts.function(SETUP, f"vm_fetch libs {wanted}")
    assert_one_line(result, "could not fetch Debian's list", "QUIESCE_VM_CACHE=FOLDER")
    assert len(scripts.calls("apt-get")) == 3  # downloads alone are tried again


def test_damaged_package_is_fetched_again_by_itself(scripts: Clone) -> None:
    fill_cache(scripts, text="what it was")
    digest = hashlib.sha256(b"what it was").hexdigest()
    uri = f"'http://somewhere/one_1.0_arm64.deb' one_1.0_arm64.deb 9 SHA256:{digest}"
    scripts.fake(
        "apt-get",
        f"""case "$*" in
        *--print-uris*) echo "{uri}" ;;
        *download*) printf 'what it was' >one_1.0_arm64.deb ;;
        esac""",
    )
    assert scripts.function(SETUP, "vm_fetch libs one").returncode == 0
    update, uris, download = scripts.calls("apt-get")
    assert update.endswith("update")
    assert uris.endswith("--print-uris download one")
    assert download.endswith("download one")


def test_apt_keeps_to_a_root_of_its_own(scripts: Clone) -> None:
    result = scripts.function(SETUP, 'vm_apt; printf "%s\\n" "${VM_APT[@]}"')
    options = result.stdout.splitlines()
    assert f"Dir={scripts.root}/build/vm/apt" in options
    assert f"Dir::State::status={scripts.root}/build/vm/apt/var/lib/dpkg/status" in options
    texts = [(ROOT / VM / name).read_text() for name in ("build_images", "images.sh")]
    assert not any("--add-architecture" in text for text in texts)


def test_other_kernel_sources_are_refused(scripts: Clone) -> None:
    """The archive is there, but the three files are not in it."""
    cache = scripts.root / "build/vm/cache"
    cache.mkdir(parents=True)
    scripts.fake(
        "apt-get", 'case "$*" in *download*) echo none >linux-source-6.1_6.1.999-1_all.deb ;; esac'
    )
    result = scripts.function(SETUP, "gpio_sim_fetch")
    assert result.returncode == 2
    last = result.stderr.splitlines()[-1]
    assert "gpio-sim refused" in last
    assert "linux-source-6.1_6.1.999-1_all.deb" in last


def kernel_sources(folder: Path, version: str) -> Path:
    """A package of kernel sources with three files that are not those of the checksums."""
    files = ("drivers/gpio/gpio-sim.c", "drivers/gpio/gpiolib.h", "kernel/irq/irq_sim.c")
    for name in files:
        file = folder / "linux-source-6.1" / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(f"/* {name} of {version} */\n")
    tree = folder / "tree"
    (tree / "usr/src").mkdir(parents=True)
    archive = tree / "usr/src/linux-source-6.1.tar.xz"
    subprocess.run(["tar", "-cJf", archive, "-C", folder, "linux-source-6.1"], check=True)
    (tree / "DEBIAN").mkdir()
    (tree / "DEBIAN/control").write_text(
        f"Package: linux-source-6.1\nVersion: {version}\nArchitecture: all\n"
        "Maintainer: nobody <nobody@localhost>\nDescription: sources\n"
    )
    package = folder / f"linux-source-6.1_{version}_all.deb"
    subprocess.run(["dpkg-deb", "--build", tree, package], check=True, capture_output=True)
    return package


def fetch_gpio_sim(scripts: Clone, package: Path) -> subprocess.CompletedProcess[str]:
    (scripts.root / "build/vm/cache").mkdir(parents=True)
    scripts.fake("apt-get", f"""case "$*" in *download*) cp "{package}" . ;; esac""")
    return scripts.function(SETUP, "gpio_sim_fetch && gpio_sim_fetch")


def test_newer_kernel_sources_are_taken_as_apt_verified_them(
    scripts: Clone, tmp_path: Path
) -> None:
    result = fetch_gpio_sim(scripts, kernel_sources(tmp_path / "new", "6.1.999-1"))
    assert result.returncode == 0, result.stderr
    assert len(scripts.calls("apt-get")) == 2  # list and package: the second time all is there
    told = [line for line in result.stderr.splitlines() if "apt verified" in line]
    assert len(told) == 1 and "linux-source-6.1 is 6.1.999-1" in told[0]
    folder = scripts.root / "build/vm/cache/gpio-sim"
    assert "6.1.999-1" in (folder / "gpio-sim.c").read_text()
    (folder / "gpio-sim.c").write_text("changed")
    assert scripts.function(SETUP, f"gpio_sim_is_complete '{folder}'").returncode == 1


def test_kernel_sources_of_the_known_version_have_the_known_files(
    scripts: Clone, tmp_path: Path
) -> None:
    version = scripts.function(SETUP, 'printf %s "$GPIO_SIM_VERSION"').stdout
    result = fetch_gpio_sim(scripts, kernel_sources(tmp_path / "known", version))
    assert result.returncode == 2
    assert "gpio-sim refused" in result.stderr.splitlines()[-1]


def test_changed_file_of_gpio_sim_is_not_complete(scripts: Clone) -> None:
    folder = scripts.root / "build/vm/cache/gpio-sim"
    folder.mkdir(parents=True)
    for name in ("gpio-sim.c", "gpiolib.h", "irq_sim.c"):
        (folder / name).write_text("changed")
    assert scripts.function(SETUP, f"gpio_sim_is_complete '{folder}'").returncode == 1
