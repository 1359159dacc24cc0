"""Tables of the controller: their words, their kinds, and the one kind of file that they are in."""
