"""Images that must not be flashed: damaged, cut off, of another maker or board, too old."""

from collections.abc import Iterator
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from quiesce.base.paths import build_folder
from quiesce.engine.bench import require_file
from quiesce.firmware.container import make_keys, sign
from quiesce.firmware.image import sealed
from quiesce.firmware.making import Made
from quiesce.firmware.release import refusal, signed_file, write_release, write_sums

from quiesce_benchmarks.part import Effort, Measured

TITLE = "images: what must not be flashed is refused"
DAMAGED, CUT, OTHERS = 400, 95, 5
FIGURES = (
    ("images_refused", "images", float(DAMAGED + CUT + OTHERS), "higher"),
    ("images_good_taken", "images", 1.0, "higher"),
)
BOARD, OTHER_BOARD = "nucleo_f446re", "olimex_h405"
MOST_DAMAGE = 8  # bytes of one image


def damaged(data: bytes, rng: np.random.Generator) -> Iterator[bytes]:
    """Some bytes are others; every third time near an end."""
    for number in range(DAMAGED):
        broken = bytearray(data)
        width = 256 if number % 3 == 0 else len(data)
        for _ in range(rng.integers(1, MOST_DAMAGE + 1)):
            at = int(rng.integers(width))
            at = len(data) - 1 - at if number % 6 == 0 else at
            broken[at] ^= int(rng.integers(1, 256))
        if bytes(broken) != data:
            yield bytes(broken)
        else:
            yield data[:-1]


def cut(data: bytes, rng: np.random.Generator) -> Iterator[bytes]:
    for length in rng.integers(0, len(data), CUT):
        yield data[: int(length)]


def measure(effort: Effort) -> Measured:
    name = f"stm32f4/targets/stm32f4/quiesce_stm32f4_{BOARD}.elf"
    elf = require_file(build_folder() / name, "the image")
    rng = np.random.default_rng(effort.seed)
    with TemporaryDirectory() as place:
        folder = Path(place) / "release"
        folder.mkdir()
        keys = [Path(place) / one for one in ("a.pem", "a_public.pem", "b.pem", "b_public.pem")]
        make_keys(*keys[:2])
        make_keys(*keys[2:])
        image = write_release(Made.of(elf), keys[0], "", folder)
        major, minor, patch = image.version
        good = refusal(folder, keys[1], BOARD, image.version) == ""
        refused = bool(refusal(folder, keys[1], OTHER_BOARD, None))
        refused += bool(refusal(folder, keys[1], BOARD, (major, minor, patch + 1)))
        refused += bool(refusal(folder, keys[3], BOARD, None))
        data = signed_file(folder).read_bytes()
        for broken in (*damaged(data, rng), *cut(data, rng)):
            refused += is_refused(folder, broken, keys[1])
        payload = sealed(image.payload)
        sign(payload, image.version_text, None, signed_file(folder))
        refused += is_refused(folder, signed_file(folder).read_bytes(), keys[1])
        other = payload[:5000] + bytes([payload[5000] ^ 1]) + payload[5001:]
        sign(other, image.version_text, keys[0], signed_file(folder))
        refused += is_refused(folder, signed_file(folder).read_bytes(), keys[1])
    return Measured({"images_refused": float(refused), "images_good_taken": float(good)})


def is_refused(folder: Path, data: bytes, key: Path) -> bool:
    """With sums that fit: whoever damages an image can write those, too."""
    signed_file(folder).write_bytes(data)
    write_sums(folder)
    return bool(refusal(folder, key, BOARD, None))
