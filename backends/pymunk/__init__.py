"""pymunk (Chipmunk): a planar engine, joints are constraints."""
