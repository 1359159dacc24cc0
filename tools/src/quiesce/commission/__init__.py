"""From an unknown structure to a controller at work on it that is verified: a step after another,
each left and resumed at will. docs/howto/commission.md."""
