"""Published laws on structures with published results."""
