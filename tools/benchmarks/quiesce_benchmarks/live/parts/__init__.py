"""Parts of `./tools/benchmark live`."""
