"""Control laws as tables, for the firmware's laws linear, signs, friction and polynomial: made from
a structure, a board and a recipe."""
