"""Jobs, and the processes in which they run."""
