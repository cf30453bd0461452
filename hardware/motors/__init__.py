"""Models of motors, as a data sheet describes them."""
