"""Searches over the unit cube by the names that papers give them."""
