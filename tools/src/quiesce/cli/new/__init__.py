"""`quiesce new`: files to begin with."""
