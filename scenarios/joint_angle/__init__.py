"""An arm of two links whose joint angle is told from accelerometers."""
