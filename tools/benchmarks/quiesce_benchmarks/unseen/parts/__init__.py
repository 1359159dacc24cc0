"""Parts of `./tools/benchmark unseen`: one module each, with FIGURES and measure(effort)."""
