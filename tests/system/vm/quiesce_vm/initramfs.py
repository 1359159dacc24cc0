"""The guest's memory file system: kernel modules, tools, our programs and scripts."""

from dataclasses import dataclass
from pathlib import Path

from quiesce.base.errors import UsageError
from quiesce.base.paths import build_folder, root

from quiesce_vm.cpio import Archive
from quiesce_vm.kernel_modules import load_order
from quiesce_vm.libraries import closure

ELF_AARCH64 = b"\xb7\x00"
MODULES = [
    *("can", "can_raw", "can_dev", "vcan", "slcan", "configfs"),
    "gpio_sim",
]
LATER_MODULES = ["softdog"]  # a script loads them when it wants them
# Unit tests that want a kernel with CAN and gpio-sim.
BACKEND_TESTS = ("test_can_kernel", "test_gpio_lines_1", "test_gpio_lines_2")
TOOLS = {
    **{name: f"usr/bin/{name}" for name in ("slcand", "cansend", "candump", "gpioset", "gpioinfo")},
    "cyclictest": "usr/bin/cyclictest",
    "iproute2": "bin/ip",  # busybox has an ip of its own
}


@dataclass(frozen=True)
class Parts:
    """Where the parts are; all made by tests/system/vm/build_images."""

    arm64: Path  # Debian's arm64 packages, unpacked
    kernel: Path
    programs: Path  # the build for arm64 with libgpiod 1.6 and the guest's programs
    programs_gpiod2: Path
    guest: Path  # init and scripts

    @staticmethod
    def built() -> "Parts":
        """UsageError where tests/system/vm/build_images has not run."""
        build = build_folder()
        parts = Parts(
            arm64=build / "deps/arm64",
            kernel=build / "vm/kernel",
            programs=build / "arm64",
            programs_gpiod2=build / "arm64-gpiod2",
            guest=root() / "tests/system/vm/guest",
        )
        for path in (parts.arm64, parts.kernel / "vmlinuz", parts.programs, parts.programs_gpiod2):
            if not path.exists():
                raise UsageError(f"{path} is missing: run tests/system/vm/build_images")
        return parts

    @property
    def vmlinuz(self) -> Path:
        return self.kernel / "vmlinuz"


def build(parts: Parts, output: Path) -> Path:
    """Writes the archive, uncompressed: the emulated processor would take longer to expand it."""
    archive = Archive()
    for folder in ("dev", "proc", "sys", "run", "tmp", "var/lib"):
        archive.add_folder(folder)
    _add(archive, "bin/busybox", parts.arm64 / "bin/busybox")
    archive.add_link("bin/sh", "busybox")
    for file in sorted(parts.guest.iterdir()):
        if file.suffix in ("", ".sh", ".toml"):
            _add(archive, "init" if file.name == "init" else f"vm/{file.name}", file)
    _add_modules(archive, parts)
    _add_programs(archive, parts)
    output.write_bytes(archive.content())
    return output


def _add_modules(archive: Archive, parts: Parts) -> None:
    first = load_order(parts.kernel, MODULES)
    later = [file for file in load_order(parts.kernel, LATER_MODULES) if file not in first]
    for file in [*first, *later]:
        _add(archive, f"lib/modules/{file.name}", file)
    order = "".join(f"{file.name}\n" for file in first)
    archive.add_file("lib/modules/order", order.encode(), 0o644)


def _add_programs(archive: Archive, parts: Parts) -> None:
    programs = {f"bin/{name}": parts.arm64 / file for name, file in TOOLS.items()}
    programs["bin/quiesced"] = parts.programs / "targets/linux/quiesced/quiesced"
    programs["bin/quiesced-gpiod2"] = parts.programs_gpiod2 / "targets/linux/quiesced/quiesced"
    for name in BACKEND_TESTS:
        programs[f"bin/{name}"] = parts.programs / "tests/unit/linux" / name
    for file in sorted((parts.programs / "tests/system/vm/guest").glob("vm_*")):
        if file.is_file() and not file.suffix:
            programs[f"bin/{file.name}"] = file
    for name, file in programs.items():
        _add(archive, name, file)
    # libgpiod 2.x, which Debian 12 does not have; both builds make it.
    built = (parts.programs / "hal/linux", parts.programs_gpiod2 / "hal/linux")
    libraries = closure(parts.arm64, list(programs.values()), built)
    libraries["ld-linux-aarch64.so.1"] = parts.arm64 / "lib/ld-linux-aarch64.so.1"
    for name, file in libraries.items():
        _add(archive, f"lib/{name}", file)


def _add(archive: Archive, name: str, file: Path) -> None:
    try:
        data = file.read_bytes()
    except OSError as error:
        raise UsageError(f"{file}: {error.strerror}: run tests/system/vm/build_images")
    # An absolute link in an unpacked package leads to this machine's own file.
    if data[:4] == b"\x7fELF" and data[18:20] != ELF_AARCH64:
        raise UsageError(f"{file}: not for arm64")
    archive.add_file(name, data)
