"""Measured figures beside their goals: `./tools/benchmark NAME`. Nothing in quiesce imports this."""
