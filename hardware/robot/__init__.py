"""The table-top robot as open hardware: one file of its parts, and all that follows from it."""
