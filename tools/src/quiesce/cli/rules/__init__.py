"""The actions of `quiesce rules`, one module each."""
