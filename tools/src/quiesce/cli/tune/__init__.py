"""`quiesce tune`: pulses for a plant, and laws with gains (`tune law`)."""
