"""The service of the arm64 package under systemd and udev, in a virtual machine with a real-time
kernel. Its time is the count of its instructions: the load of this machine does not matter."""

import shutil
import subprocess
from pathlib import Path

import pytest
from conftest import BUILD, ROOT, as_root, run

GUEST = ROOT / "tests/system/package/guest"
MODULES = ("can", "can-raw", "can-dev", "vcan", "softdog")
CAP_SYS_NICE, CAP_IPC_LOCK, CAP_NET_ADMIN = 23, 14, 12

FACTS = {
    "gpiochip0": "quiesced 660",
    "watchdog": "quiesced 660",
    "watchdog0": "quiesced 660",
    "start": "active",
    "user": "quiesced",
    "groups": "dialout quiesced",
    "capabilities": f"{1 << CAP_SYS_NICE | 1 << CAP_IPC_LOCK | 1 << CAP_NET_ADMIN:016x}",
    "seccomp": "2",
    "priorities": "0 80",
    "reload": "yes",
    "refusal": "yes",
    "after_refusal": "active same",
    "restart_after_kill": "yes",
    "hang_is_noticed": "yes",
    "restart_after_hang": "yes",
    "stop": "inactive success",
    "farewell": "yes",
    "failures_to_make_safe": "0",
    "tries": "yes",
    "late_interface": "yes",
}


def require(path: Path, command: str) -> Path:
    if not path.exists():
        pytest.fail(f"{path} is not there; run {command}", pytrace=False)
    return path


def make_root(folder: Path) -> None:
    """A Debian with the package in it, as dpkg and its scripts would leave it."""
    origin = require(BUILD / "package/root-service", "./tools/package --root arm64")
    (package,) = BUILD.glob("packages/quiesced_*_arm64.deb")
    kernel = require(BUILD / "vm/kernel/root", "./tests/system/vm/build_images kernel")
    as_root("cp", "-a", origin, folder)
    # Its /lib goes where the root's leads to.
    unpack = f'dpkg-deb --fsys-tarfile "{package}" | tar -x --keep-directory-symlink -C "{folder}"'
    as_root("sh", "-c", unpack)
    as_root("systemd-sysusers", f"--root={folder}")
    as_root("mkdir", folder / "modules")
    for name in MODULES:
        (module,) = kernel.rglob(f"{name}.ko")
        as_root("cp", module, folder / "modules")
    as_root("cp", GUEST / "init", GUEST / "probe.sh", folder)
    as_root("chmod", "755", folder / "init")
    as_root("cp", GUEST / "probe.service", folder / "etc/systemd/system")
    as_root("sed", "-i", "s/can0/vcan0/", folder / "etc/quiesced/quiesced.toml")
    as_root("systemctl", f"--root={folder}", "enable", "probe.service")
    as_root("touch", folder / "etc/machine-id")  # or the first boot asks questions
    as_root("systemctl", f"--root={folder}", "mask", "serial-getty@ttyAMA0.service")
    as_root(
        "rm", "-rf", folder / ".emulator", folder / "usr/share/doc", folder / "usr/share/locale"
    )


@pytest.fixture(scope="module")
def console(tmp_path_factory: pytest.TempPathFactory) -> str:
    """What the machine said until it switched itself off."""
    work = tmp_path_factory.mktemp("service")
    make_root(work / "root")
    as_root(
        "sh", "-c", 'cd "$1" && find . | cpio --create --format newc --quiet | gzip -1 >"$2"',
        "sh", work / "root", work / "root.cpio.gz",
    )  # fmt: skip
    as_root("rm", "-rf", work / "root")
    kernel = require(BUILD / "vm/kernel/vmlinuz", "./tests/system/vm/build_images kernel")
    said = work / "console.txt"
    try:
        result = run(
            shutil.which("qemu-system-aarch64") or "qemu-system-aarch64",
            "-M", "virt", "-cpu", "cortex-a53", "-m", "1200", "-accel", "tcg",
            "-icount", "shift=2,sleep=off", "-rtc", "clock=vm,base=2020-01-01", "-seed", "1",
            "-display", "none", "-no-reboot", "-nic", "none", "-monitor", "none",
            "-serial", f"file:{said}", "-kernel", kernel, "-initrd", work / "root.cpio.gz",
            "-append", "console=ttyAMA0 panic=-1 quiet loglevel=3 nokaslr systemd.show_status=0",
        )  # fmt: skip
    except subprocess.TimeoutExpired as late:
        last = said.read_text(errors="replace")[-4000:]
        pytest.fail(f"not off after {late.timeout:g} s; {said} ends in:\n{last}", pytrace=False)
    (work / "root.cpio.gz").unlink()
    text = said.read_text(errors="replace")
    assert "FACT end" in text, text[-4000:] + result.stderr
    return text


@pytest.mark.parametrize(("name", "expected"), FACTS.items())
def test_service(console: str, name: str, expected: str) -> None:
    facts = [line.split()[1:] for line in console.splitlines() if line.startswith("FACT ")]
    found = {words[0]: " ".join(words[1:]) for words in facts}
    assert found[name] == expected


def test_memory_is_locked(console: str) -> None:
    (locked,) = [line for line in console.splitlines() if line.startswith("FACT locked")]
    assert int(locked.split()[2]) > 4096
