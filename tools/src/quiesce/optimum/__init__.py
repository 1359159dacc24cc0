"""The best that any current can do to a plant: periodic optimal control and its store."""
