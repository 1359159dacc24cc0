"""Benchmark of identification on dampers and rigs that nothing was tuned on."""
