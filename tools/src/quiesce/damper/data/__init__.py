"""From any delimited text file of a test rig to checked, conditioned records in SI units."""
