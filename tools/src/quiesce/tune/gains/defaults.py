"""What a tuning takes where nothing is said, for command lines that start without libraries."""

INDEX = "index"  # of `quiesce compare`
WORST_WEIGHT = 0.5  # of the worst record beside the mean
TRIALS = 96
