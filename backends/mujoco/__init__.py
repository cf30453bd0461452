"""MuJoCo: trees of bodies in reduced coordinates, whose contacts are springs and dampers."""
