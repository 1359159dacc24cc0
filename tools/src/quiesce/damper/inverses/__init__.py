"""Inverses of dampers: the current for a wanted force, by several methods, in files, compared."""
