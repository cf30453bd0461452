"""Published worked examples, recomputed."""
