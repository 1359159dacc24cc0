"""Plants as Python sees them: the C library, files, variants."""
