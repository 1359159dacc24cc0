"""Images of boards: built, sealed, signed, read, verified, flashed."""
