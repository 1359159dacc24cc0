"""`quiesce firmware`."""
