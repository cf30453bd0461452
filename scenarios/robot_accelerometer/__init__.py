"""A seismic mass held by a force sensor on a robot that drives."""
