"""Box2D 3 through ``pyb2d3``: a planar engine in single precision, joints are soft constraints."""
