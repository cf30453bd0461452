"""What a report says of a data sheet."""
