"""Motion that no table and no threshold was chosen on."""
