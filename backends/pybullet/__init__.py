"""PyBullet: Bullet 3, trees of bodies in reduced coordinates."""
