"""What a run, a fit or a validation found: records, and where they are stored."""
