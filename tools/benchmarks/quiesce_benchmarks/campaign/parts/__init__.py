"""Parts of the benchmark of campaigns."""
