"""A structure from a recorded sweep."""
