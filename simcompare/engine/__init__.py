"""What stands between a scenario and an engine; adapters take it from ``simcompare.kit``."""
