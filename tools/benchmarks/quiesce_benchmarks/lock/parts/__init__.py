"""Parts of the benchmark: what all_parts of part.py wants of a module."""
