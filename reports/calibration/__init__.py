"""What a report says of the calibration of a sensor."""
