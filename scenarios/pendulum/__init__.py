"""A single pendulum that swings freely, with viscous and dry friction in its hinge."""
