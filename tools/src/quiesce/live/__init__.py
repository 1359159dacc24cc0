"""The page of `quiesce live`: what a controller does, seen and commanded in a browser."""
