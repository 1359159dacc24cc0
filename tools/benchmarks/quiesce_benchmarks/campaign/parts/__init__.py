"""Parts of it, each with its figure."""
