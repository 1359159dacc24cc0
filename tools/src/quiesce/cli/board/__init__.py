"""The actions of `quiesce board`, one module each."""
