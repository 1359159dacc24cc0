"""What rules of any kind answer over two inputs, as values on a grid: the form in which a running
controller takes what plain tables cannot hold."""
