"""Names of the searches, for command lines that start without their libraries."""

NAMES = ("pso", "cmaes", "es", "cuckoo", "bees")
