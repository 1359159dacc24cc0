"""Flash and memory of an image by what the library in it holds."""

import tempfile
from pathlib import Path

from quiesce.base.table import format_table

from quiesce_benchmarks.install.outside import build_image, run
from quiesce_benchmarks.part import Effort, Measured

TITLE = "footprint: an image for a Cortex-M4, -Os, by choice of laws and sizes"
FIGURES = (
    ("lib_fuzzy_kB", "kB", 28.0, "lower"),
    ("lib_fuzzy_loaded_kB", "kB", None, "lower"),
    ("lib_all_kB", "kB", None, "lower"),
)

FUZZY = {"QUIESCE_LAWS": "fuzzy", "QUIESCE_TRACKERS": "compare", "QUIESCE_ESTIMATORS": "fit"}
# Rows of the page: what is chosen, and the options that choose it.
CHOICES: dict[str, dict[str, str]] = {
    "fuzzy law, the rules that ship": FUZZY | {"QUIESCE_RULE_TABLES": "OFF"},
    "fuzzy law": FUZZY,
    "fuzzy law, FFT": FUZZY | {"QUIESCE_ESTIMATORS": "fft"},
    "fuzzy and self-tuning laws": FUZZY | {"QUIESCE_LAWS": "fuzzy;fuzzy_selftune"},
    "rules on any signal": FUZZY | {"QUIESCE_LAWS": "fuzzy_signals"},
    "sign patterns (skyhook and its like)": FUZZY | {"QUIESCE_LAWS": "signs"},
    "linear laws, all trackers": FUZZY | {"QUIESCE_LAWS": "linear", "QUIESCE_TRACKERS": "all"},
    "phase law": FUZZY | {"QUIESCE_LAWS": "phase"},
    "all laws and trackers": FUZZY | {"QUIESCE_LAWS": "all", "QUIESCE_TRACKERS": "all"},
    "everything": {name: "all" for name in ("QUIESCE_LAWS", "QUIESCE_TRACKERS")}
    | {"QUIESCE_ESTIMATORS": "fit;fft"},
    "everything, 8 sensors, 4 dampers": {
        "QUIESCE_LAWS": "all",
        "QUIESCE_TRACKERS": "all",
        "QUIESCE_ESTIMATORS": "fit;fft",
        "QUIESCE_SENSORS": "8",
        "QUIESCE_BODIES": "4",
        "QUIESCE_DAMPERS": "4",
    },
}
SMALLEST = next(iter(CHOICES))
QUICK = (SMALLEST, "fuzzy law", "everything")


def size_of(image: Path) -> tuple[int, int]:
    """Bytes of flash and of memory, the stack aside: as arm-none-eabi-size counts."""
    text, data, bss = map(int, run("arm-none-eabi-size", image).splitlines()[1].split()[:3])
    return text + data, data + bss


def measure(effort: Effort) -> Measured:
    sizes = {}
    with tempfile.TemporaryDirectory() as folder:
        for name, options in CHOICES.items():
            if not effort.is_quick or name in QUICK:
                image = build_image(Path(folder) / str(len(sizes)), **options)
                sizes[name] = size_of(image)
    rows = [[name, f"{flash:,}", f"{ram:,}"] for name, (flash, ram) in sizes.items()]
    return Measured(
        {
            "lib_fuzzy_kB": sizes[SMALLEST][0] / 1000.0,
            "lib_fuzzy_loaded_kB": sizes["fuzzy law"][0] / 1000.0,
            "lib_all_kB": sizes["everything"][0] / 1000.0,
        },
        {"sizes": {name: {"flash_B": f, "ram_B": r} for name, (f, r) in sizes.items()}},
        (format_table(["the library holds", "flash, B", "memory, B"], rows, left=(0,)),),
    )
