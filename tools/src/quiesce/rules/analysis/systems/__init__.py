"""What can be said of a fuzzy system of any kind before it runs: proved where that can be, else
sampled."""
