"""Measured figures beside their goals (`./tools/benchmark NAME`); quiesce imports none of it."""
