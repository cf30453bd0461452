"""A pendulum on one hinge, driven by a position servo."""
