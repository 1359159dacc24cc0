"""`./tools/benchmark live`: the page of a controller at work, in a real browser."""
