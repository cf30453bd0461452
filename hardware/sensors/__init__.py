"""Models of sensors: what they resolve, and how sure their readings are."""
