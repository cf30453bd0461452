"""A seismic mass held by a force sensor, at rest on a slope."""
