"""What a report says of a fit."""
