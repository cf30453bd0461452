"""What is simulated and what is recorded: scenarios, trajectories, recordings, settings."""
