"""Two clocks, one time: by waveforms, by events, by a line between two clocks."""
