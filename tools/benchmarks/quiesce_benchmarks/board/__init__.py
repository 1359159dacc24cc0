"""What the firmware asks of a board, and whether it does the same on all of them."""
