"""An engine's own contact numbers for a restitution, measured in the engine."""
