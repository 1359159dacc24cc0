"""Small networks: fitted in float64, then in the integers that the controller works with."""
