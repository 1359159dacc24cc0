"""A measuring campaign, from the files that a laboratory has to a damper in a controller."""
