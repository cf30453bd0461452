"""What a recording says of a scenario: plan, segments, reference model, estimate."""
