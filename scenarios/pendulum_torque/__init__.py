"""A pendulum on one hinge, driven by a given torque."""
