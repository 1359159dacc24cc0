"""How long the host waits for the guest. A guest's own limits are in its own time, or in frames."""

# Only ends a wait for a guest that hangs: no result depends on it, however slow the host is.
HANG_S = 1800.0
