"""Parts of the benchmark, a file each: FIGURES, TITLE and measure(effort) -> Measured."""
