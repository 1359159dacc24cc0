"""python-can without asammdf, which it imports for MDF4 files: a second that an emergency stop
does not have. MDF4 files are read and written by quiesce.can.mdf."""

import logging
import sys
import warnings

if "can" not in sys.modules and "asammdf" not in sys.modules:
    sys.modules["asammdf"] = None  # type: ignore[assignment]  # counts as not installed
    try:
        import can
    finally:
        del sys.modules["asammdf"]
else:
    import can

# Drivers log what they miss; the one line that we print says it.
logging.getLogger("can").setLevel(logging.CRITICAL + 1)
warnings.filterwarnings("ignore", module="can")

__all__ = ["can"]
