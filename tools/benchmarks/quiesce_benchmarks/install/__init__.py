"""Figures of Quiesce outside of its own tree: as a library, as a package."""
