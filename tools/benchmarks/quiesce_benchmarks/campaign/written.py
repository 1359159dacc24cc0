"""One damper test as other programs write it: each file by another hand than the one that reads it,
but for HDF5, which has one library. What no library writes is laid down here byte by byte."""

import struct
from collections.abc import Callable, Mapping
from pathlib import Path

import numpy as np

# Columns by role: name and unit, as a laboratory calls them.
NAMES = {
    "time": ("t", "s"),
    "displacement": ("x", "mm"),
    "force": ("f", "N"),
    "current": ("i", "A"),
}
RATE_Hz = 500.0
Columns = Mapping[str, np.ndarray]


def recording(rows: int = 2000) -> dict[str, np.ndarray]:
    """By role, in the units of NAMES."""
    time_s = np.arange(rows) / RATE_Hz
    turn = 2.0 * np.pi * 2.0 * time_s
    return {
        "time": time_s,
        "displacement": 10.0 * np.sin(turn),
        "force": 300.0 * np.tanh(4.0 * np.cos(turn)) + 20.0 * np.cos(turn),
        "current": np.full(rows, 0.5),
    }


def named(columns: Columns) -> dict[str, np.ndarray]:
    """Under names that end in their unit: x_mm."""
    return {f"{NAMES[role][0]}_{NAMES[role][1]}": one for role, one in columns.items()}


def mat_5(file: Path, columns: Columns) -> None:
    """MATLAB's version 5, as its layout is published: header, then a matrix a variable."""

    def element(kind: int, data: bytes) -> bytes:
        return struct.pack("<II", kind, len(data)) + data.ljust(-(-len(data) // 8) * 8, b"\0")

    parts = [b"MATLAB 5.0 MAT-file, by hand".ljust(116), bytes(8), struct.pack("<H", 0x100), b"IM"]
    for name, values in named(columns).items():
        flags = element(6, struct.pack("<II", 6, 0))  # class: double
        sizes = element(5, struct.pack("<ii", len(values), 1))
        body = (
            flags + sizes + element(1, name.encode()) + element(9, values.astype("<f8").tobytes())
        )
        parts.append(struct.pack("<II", 14, len(body)) + body)
    file.write_bytes(b"".join(parts))


def mat_73(file: Path, columns: Columns) -> None:
    """Version 7.3 by hdf5storage, with the variables in a struct."""
    import hdf5storage

    hdf5storage.savemat(str(file), {"test": named(columns)}, format="7.3", oned_as="column")


def hdf5(file: Path, columns: Columns) -> None:
    """Data sets in a group, units as attributes, by h5py, which reads it, too."""
    import h5py

    with h5py.File(file, "w") as stream:
        for role, values in columns.items():
            name, unit = NAMES[role]
            stream.create_dataset(f"run/{name}", data=values).attrs["unit"] = unit


def parquet(file: Path, columns: Columns) -> None:
    """By fastparquet."""
    import fastparquet
    import pandas

    fastparquet.write(str(file), pandas.DataFrame(named(columns)), compression="GZIP")


def uff_58(file: Path, columns: Columns) -> None:
    """Universal data sets 58 as text, doubles at even times."""
    time_s = columns["time"]
    lines: list[str] = []
    for number, (role, values) in enumerate(columns.items()):
        if role == "time":
            continue
        name, unit = NAMES[role]
        entry = f" {'NONE':<10s}{number:10d}{1:4d}"
        blank = f" {'NONE':<20s} {'NONE':<20s}"
        lines += ["    -1", "    58", name, "NONE", "01-Jan-26 00:00:00", "NONE", "NONE"]
        lines += [f"{1:5d}{0:10d}{0:5d}{0:10d}{entry}{entry}"]
        step_s = time_s[1] - time_s[0]
        lines += [f"{4:10d}{len(values):10d}{1:10d}{time_s[0]:13.5e}{step_s:13.5e}{0.0:13.5e}"]
        lines += [f"{17:10d}{0:5d}{0:5d}{0:5d} {'Time':<20s} {'s':<20s}"]
        lines += [f"{0:10d}{0:5d}{0:5d}{0:5d} {name:<20s} {unit:<20s}"]
        lines += [f"{0:10d}{0:5d}{0:5d}{0:5d}{blank}"] * 2
        for first in range(0, len(values), 4):
            lines.append("".join(f"{value:20.12e}" for value in values[first : first + 4]))
        lines.append("    -1")
    file.write_text("\n".join(lines) + "\n", encoding="ascii")


def lvm(file: Path, columns: Columns) -> None:
    """LabVIEW's text with tabs and decimal commas, as it writes it where those are usual."""
    roles = [role for role in columns if role != "time"]
    head = ["LabVIEW Measurement\t", "Writer_Version\t2", "Separator\tTab", "Decimal_Separator\t,"]
    head += ["X_Columns\tOne", "***End_of_Header***\t", "\t", f"Channels\t{len(roles)}"]
    head.append("\t".join(["Samples", *[str(len(columns["time"]))] * len(roles)]))
    head.append("\t".join(["Y_Unit_Label", *(NAMES[role][1] for role in roles)]))
    head += ["***End_of_Header***\t" + "\t" * len(roles)]
    head.append("\t".join(["X_Value", *(NAMES[role][0] for role in roles), "Comment"]))
    rows = zip(columns["time"], *(columns[role] for role in roles), strict=True)
    body = ["\t".join(f"{value:.9f}" for value in row).replace(".", ",") for row in rows]
    file.write_text("\n".join([*head, *body, ""]), encoding="utf-8")


def mdf_4(file: Path, columns: Columns) -> None:
    """One group of an MDF 4.10 file, sorted and without compression, block after block."""
    out = bytearray(
        struct.pack("<8s8s8s4xH30xHH", b"MDF     ", b"4.10    ", b"by hand ", 410, 0, 0)
    )

    def block(kind: bytes, links: list[int], data: bytes) -> int:
        """Its address."""
        out.extend(bytes(-len(out) % 8))
        at, count = len(out), len(links)
        length = 24 + 8 * count + len(data)
        out.extend(struct.pack(f"<4s4xQQ{count}Q", kind, length, count, *links) + data)
        return at

    def text(words: str) -> int:
        data = words.encode() + b"\0"
        return block(b"##TX", [], data.ljust(-(-len(data) // 8) * 8, b"\0"))

    start = block(b"##HD", [0] * 6, bytes(32))
    history = block(b"##FH", [0, block(b"##MD", [], b"<FHcomment/>\0\0\0\0")], bytes(16))
    values = np.stack(list(columns.values()), axis=1).astype("<f8")
    data = block(b"##DT", [], values.tobytes())
    channel = 0
    for number, role in reversed(list(enumerate(columns))):
        name, unit = NAMES[role]
        is_time = role == "time"
        # type, sync, float, offset in bits and bytes, bits; then flags, ranges and limits: none.
        facts = struct.pack("<BBBBIIIIBBH", 2 * is_time, is_time, 4, 0, 8 * number, 64, *[0] * 5)
        links = [channel, 0, text(name), 0, 0, 0, text(unit), 0]
        channel = block(b"##CN", links, facts + bytes(48))
    sizes = struct.pack("<QQHHIII", 0, len(values), 0, 0, 0, values.shape[1] * 8, 0)
    group = block(b"##CG", [0, channel, 0, 0, 0, 0], sizes)
    first = block(b"##DG", [0, group, data, 0], bytes(8))
    struct.pack_into("<QQ", out, start + 24, first, history)
    file.write_bytes(out)


def german_csv(file: Path, columns: Columns) -> None:
    """Semicolons, decimal commas, and names that a file beside it has to explain."""
    words = {
        "time": "Zeit [s]",
        "displacement": "Weg (mm)",
        "force": "Kraft in N",
        "current": "Strom/A",
    }
    rows = zip(*columns.values(), strict=True)
    body = [";".join(f"{value:.9f}" for value in row).replace(".", ",") for row in rows]
    head = ";".join(words[role] for role in columns)
    file.write_text("\n".join([head, *body, ""]), encoding="utf-8")


# Format -> the file's name and who writes it.
WRITERS: dict[str, tuple[str, Callable[[Path, Columns], None]]] = {
    "CSV, German": ("rig.csv", german_csv),
    "MAT 5": ("rig_5.mat", mat_5),
    "MAT 7.3": ("rig_73.mat", mat_73),
    "HDF5": ("rig.h5", hdf5),
    "Parquet": ("rig.parquet", parquet),
    "UFF 58": ("rig.uff", uff_58),
    "LVM": ("rig.lvm", lvm),
    "MDF 4": ("rig.mf4", mdf_4),
}
