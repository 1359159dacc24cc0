"""Banks of models at constant currents: words of tracker `bank`, and their fit to any damper."""
