"""A seismic mass held by a force sensor, in free fall."""
