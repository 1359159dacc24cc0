"""From a rule base to integers, C, and what is proved of them."""
