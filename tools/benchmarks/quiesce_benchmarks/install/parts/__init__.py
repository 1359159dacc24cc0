"""One part a module; quiesce_benchmarks.part says what each has."""
