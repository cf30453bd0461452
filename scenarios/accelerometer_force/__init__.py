"""A seismic mass held by a rigid force sensor."""
