"""What a report says of a validation."""
