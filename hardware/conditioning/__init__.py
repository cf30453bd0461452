"""From raw columns to a recording: units, clock, defects; every change is recorded."""
