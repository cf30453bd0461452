"""A DC motor with a flywheel that is switched on, and then to a second voltage."""
