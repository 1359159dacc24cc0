"""Parameters of damper models from measured motion and force."""
