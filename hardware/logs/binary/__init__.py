"""Arrays in binary files, and the checks before they are opened."""
