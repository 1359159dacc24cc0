"""The actions of `quiesce can`, one module each."""
