"""The actions of `quiesce law`, one module each."""
