"""What a report says of a characterization."""
