"""`quiesce fmu`."""
