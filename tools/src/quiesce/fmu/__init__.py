"""Plant, damper and controller for co-simulation: FMUs of FMI 2.0 and 3.0, made and run."""
