"""What differs between runs: found, named, and shown as one table and one figure."""
