"""Rule files read and written: FCL, FLL, FIS."""
