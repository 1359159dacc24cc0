"""Parts of `./tools/benchmark board`."""
