"""From a table's file or its source to a controller at work."""
