"""DART: trees of bodies in reduced coordinates."""
