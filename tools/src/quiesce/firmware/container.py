"""The signed container: the layout of MCUboot's imgtool, with a header before the image and a hash
and an ed25519 signature behind it. imgtool itself signs and verifies.

It is what is handed over and checked; what is flashed is the image inside. No boot loader looks at
it.
"""

import hashlib
import struct
from contextlib import redirect_stdout
from pathlib import Path
from typing import Any

from quiesce.base.errors import UsageError
from quiesce.base.extras import extra
from quiesce.base.paths import shown

MAGIC = 0x96F3B83D
HEADER_BYTES = 32
TAIL_MAGIC = 0x6907
KEY_HASH = 0x01
# Records behind the image: kind, padding, bytes.
HASH_RECORD = (0x10, 0, 32)
SIGNED_RECORDS = [(KEY_HASH, 0, 32), (0x24, 0, 64)]


def payload_of(data: bytes) -> bytes:
    """The image inside. ValueError where it is cut off."""
    if len(data) < HEADER_BYTES:
        raise ValueError("is cut off in its header")
    begin, end = ends_of(data)
    if begin < HEADER_BYTES or len(data) < end:
        raise ValueError(f"is cut off: {len(data)} bytes, its header says at least {end}")
    return data[begin:end]


def ends_of(data: bytes) -> tuple[int, int]:
    """Where the image begins and where it ends, as the header says."""
    _, _, header, _, size = struct.unpack_from("<IIHHI", data)
    return header, header + size


def version_of(data: bytes) -> tuple[int, int, int]:
    """As its header has it."""
    return struct.unpack_from("<BBH", data, 20)


def sign(payload: bytes, version: str, key: Path | None, out: Path) -> None:
    """Writes the container; without a key only the hash is in it."""
    with extra("firmware", "a signed image"):
        from imgtool.image import Image
        from imgtool.version import decode_version
    private = None if key is None else read_key(key, is_private=True)
    bare = out.with_suffix(".payload.bin")
    bare.write_bytes(payload)
    made = Image(version=decode_version(version), header_size=HEADER_BYTES, pad_header=True)
    try:
        with redirect_stdout(None):  # it says what it does
            made.load(str(bare))
            made.create(private, "hash", None)
            made.save(str(out))
    finally:
        bare.unlink()


def check(file: Path, key: Path | None) -> str:
    """What is wrong with it, in a few words; empty where nothing is. key: the maker's public one;
    without it only damage is found."""
    with extra("firmware", "a signed image"):
        from imgtool.image import Image, VerifyResult
    public = None if key is None else read_key(key, is_private=False)
    try:
        result = Image.verify(str(file), public)[0]
    except (struct.error, IndexError, ValueError, TypeError):
        return "it is cut off, or damaged behind the image"
    if result == VerifyResult.OK and (strange := strange_tail(file.read_bytes(), public)):
        return strange
    return {
        VerifyResult.OK: "",
        VerifyResult.INVALID_MAGIC: "it is no signed image",
        VerifyResult.INVALID_TLV_INFO_MAGIC: "it is cut off, or damaged where its signature begins",
        VerifyResult.INVALID_HASH: "its hash is not that of its contents",
        VerifyResult.INVALID_SIGNATURE: "it is not signed by this key",
        VerifyResult.KEY_MISMATCH: "it is signed for another kind of key",
    }.get(result, f"imgtool says {result}")


def strange_tail(data: bytes, public: Any) -> str:
    """What imgtool lets pass behind an image: other records than sign writes, another key's hash,
    bytes that nobody looks at. Empty where nothing is strange."""
    _, at = ends_of(data)
    magic, length = struct.unpack_from("<HH", data, at)
    if magic != TAIL_MAGIC or at + length != len(data):
        return "something else lies behind it"
    found = []
    at += 4
    while at < len(data):
        kind, padding, length = struct.unpack_from("<BBH", data, at)
        found.append((kind, padding, length))
        value = data[at + 4 : at + 4 + length]
        if kind == KEY_HASH and public is not None:
            if value != hashlib.sha256(public.get_public_bytes()).digest():
                return "it is signed by another key"
        at += 4 + length
    if at != len(data) or found not in ([HASH_RECORD], [HASH_RECORD, *SIGNED_RECORDS]):
        return "its records are not those that this program writes"
    return ""


def read_key(file: Path, is_private: bool) -> Any:
    """UsageError where it is none, or not ed25519."""
    with extra("firmware", "a key"):
        from cryptography.exceptions import UnsupportedAlgorithm
        from imgtool.keys import load
        from imgtool.keys.ed25519 import Ed25519, Ed25519Public
    kind = "private" if is_private else "public"
    expected = f"name a {kind} ed25519 key in PEM; `quiesce firmware key` makes a pair"
    try:
        found = load(str(file))
    except OSError as error:
        raise UsageError(f"{shown(file)}: {error.strerror}; {expected}")
    except (ValueError, TypeError, UnsupportedAlgorithm):
        raise UsageError(f"{shown(file)}: no key; {expected}")
    if found is None:
        raise UsageError(f"{shown(file)}: asks for a password; {expected}, without one")
    if not isinstance(found, Ed25519 if is_private else Ed25519Public):
        raise UsageError(f"{shown(file)}: another kind of key; {expected}")
    return found


def make_keys(private: Path, public: Path) -> None:
    """UsageError where one of the files exists."""
    with extra("firmware", "a key"):
        from imgtool.keys.ed25519 import Ed25519
    for file in (private, public):
        if file.exists():
            raise UsageError(f"{shown(file)}: exists; keys are not written over")
    made = Ed25519.generate()
    private.touch(mode=0o600, exist_ok=False)
    made.export_private(str(private))
    made.export_public(str(public))
