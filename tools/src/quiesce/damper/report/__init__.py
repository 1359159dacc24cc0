"""What an identification found, for people and for programs."""
