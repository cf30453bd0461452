"""Everything about real devices: logs, and published facts."""
