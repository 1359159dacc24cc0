"""Readers: one module a format, which recording/open.py lists."""
