"""What a report says of the noise of a sensor at rest."""
