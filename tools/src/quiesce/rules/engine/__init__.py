"""The table engine and the straight-line C, called from Python."""
