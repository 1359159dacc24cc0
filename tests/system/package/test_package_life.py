"""A package in a clean Debian 12 of its architecture: installed, upgraded, removed, purged."""

import re
from pathlib import Path

from conftest import CleanRoot, Package, Result, as_root, run, succeed

CONFIG = "/etc/quiesced/quiesced.toml"
STATE = "/var/lib/quiesced"


def newer(package: Package, folder: Path) -> Path:
    """The same package with a higher version and another configuration file."""
    tree = folder / "newer"
    succeed("dpkg-deb", "--raw-extract", package.path, tree)
    control = tree / "DEBIAN/control"
    version = package.field("Version")
    control.write_text(
        control.read_text().replace(f"Version: {version}\n", f"Version: {version}.1\n")
    )
    with (tree / CONFIG.lstrip("/")).open("a") as config:
        config.write("# of the newer version\n")
    (tree / "DEBIAN/md5sums").unlink()
    succeed("dpkg-deb", "--root-owner-group", "--build", tree, folder / "newer.deb")
    return folder / "newer.deb"


def user_is_there(root: CleanRoot) -> bool:
    return root.run("/usr/bin/getent", "passwd", "quiesced").returncode == 0


def verify_unit(root: CleanRoot) -> Result:
    return run(
        "systemd-analyze", "verify", "--man=no", f"--root={root.folder}", "--recursive-errors=no",
        "quiesced.service",
    )  # fmt: skip


def test_unit_file_has_no_mistakes(package: Package, clean_root: CleanRoot) -> None:
    clean_root.dpkg("--install", clean_root.copy_in(package.path, "quiesced.deb"))
    result = verify_unit(clean_root)
    assert result.returncode == 0, result.stderr
    assert result.stdout + result.stderr == ""
    unit = clean_root.folder / "lib/systemd/system/quiesced.service"
    text = unit.read_text()
    for mistake in ("ExecStrat=/usr/sbin/quiesced", "ExecStart=/usr/sbin/quiecsed"):
        unit.write_text(re.sub("(?m)^ExecStart=.*", mistake, text))
        result = verify_unit(clean_root)
        assert result.returncode != 0 or "ExecStrat" in result.stderr, mistake


def test_installed_program_runs_and_explains_its_configuration(
    package: Package, clean_root: CleanRoot
) -> None:
    clean_root.dpkg("--install", clean_root.copy_in(package.path, "quiesced.deb"))
    version = clean_root.succeed("/usr/sbin/quiesced", "--version")
    assert version.startswith(f"quiesced {package.field('Version')} (libgpiod 1.")
    assert f"{CONFIG}: every key is right\n" in clean_root.succeed("/usr/sbin/quiesced", "--check")
    as_root("sh", "-c", f'echo "tick = 1" >>"{clean_root.folder}{CONFIG}"')
    wrong = clean_root.run("/usr/sbin/quiesced", "--check")
    assert wrong.returncode == 2
    assert CONFIG in wrong.stdout and "tick" in wrong.stdout


def test_installing_makes_the_user_and_starts_nothing(
    package: Package, clean_root: CleanRoot
) -> None:
    deb = clean_root.copy_in(package.path, "quiesced.deb")
    clean_root.dpkg("--install", deb)
    assert ":/var/lib/quiesced:/usr/sbin/nologin" in clean_root.succeed(
        "/usr/bin/getent", "passwd", "quiesced"
    )
    assert clean_root.succeed("/usr/bin/getent", "group", "quiesced").startswith("quiesced:")
    wants = clean_root.folder / "etc/systemd/system/multi-user.target.wants"
    assert not (wants / "quiesced.service").is_symlink()
    before = clean_root.files()
    clean_root.dpkg("--install", deb)  # twice is once
    assert clean_root.files() == before


def test_upgrade_keeps_what_the_administrator_wrote(
    package: Package, clean_root: CleanRoot, tmp_path: Path
) -> None:
    clean_root.dpkg("--install", clean_root.copy_in(package.path, "quiesced.deb"))
    as_root("sh", "-c", f'echo "# ours" >>"{clean_root.folder}{CONFIG}"')
    enabled = clean_root.folder / "etc/systemd/system/multi-user.target.wants/quiesced.service"
    as_root("systemctl", f"--root={clean_root.folder}", "enable", "quiesced.service")
    assert enabled.is_symlink()
    deb = clean_root.copy_in(newer(package, tmp_path), "newer.deb")
    clean_root.dpkg("--force-confdef", "--force-confold", "--install", deb)
    assert (clean_root.folder / CONFIG.lstrip("/")).read_text().endswith("# ours\n")
    assert enabled.is_symlink()
    clean_root.dpkg("--remove", "quiesced")
    assert (clean_root.folder / CONFIG.lstrip("/")).exists()
    assert not (clean_root.folder / "usr/sbin/quiesced").exists()
    assert user_is_there(clean_root)


def test_purge_leaves_nothing(package: Package, clean_root: CleanRoot) -> None:
    before = clean_root.files()
    clean_root.dpkg("--install", clean_root.copy_in(package.path, "quiesced.deb"))
    for folder in (STATE, "/var/log/quiesced"):
        clean_root.succeed("/bin/sh", "-c", f"mkdir -p {folder}; echo 1 >{folder}/file")
        clean_root.succeed("/bin/chown", "-R", "quiesced:quiesced", folder)
    as_root("systemctl", f"--root={clean_root.folder}", "enable", "quiesced.service")
    clean_root.dpkg("--purge", "quiesced")
    assert not user_is_there(clean_root)
    assert sorted(clean_root.files() ^ before) == []
    clean_root.dpkg("--audit")
