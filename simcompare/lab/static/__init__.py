"""What pages of the lab load: scripts and styles."""
