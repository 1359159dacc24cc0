"""Published equations, tables and figures beside ours."""
