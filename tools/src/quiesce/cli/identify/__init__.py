"""`quiesce identify` and its actions, one module each."""
