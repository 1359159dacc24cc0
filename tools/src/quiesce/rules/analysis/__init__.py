"""What is wrong with a rule base, found without running it."""
