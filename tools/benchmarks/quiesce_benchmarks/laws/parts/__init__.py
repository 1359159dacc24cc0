"""One module a part: TITLE, FIGURES and measure(effort)."""
