"""What a process uses, and how busy the machine is, from the kernel's own counts."""

import os
from pathlib import Path


def cpu_s(pid: int) -> float:
    """Of all its threads since its start."""
    fields = Path(f"/proc/{pid}/stat").read_text(encoding="ascii").rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def rss_MB(pid: int) -> float:
    """What it has in memory now."""
    pages = int(Path(f"/proc/{pid}/statm").read_text(encoding="ascii").split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE") / 1e6


def busy() -> dict[str, float]:
    """What times are to be read with: the load of the last minute, and processors for it."""
    return {"load": os.getloadavg()[0], "processors": float(os.cpu_count() or 1)}
