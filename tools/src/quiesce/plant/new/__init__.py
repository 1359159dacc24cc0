"""Plant, board and scenario files for a structure that is described in a few numbers."""
