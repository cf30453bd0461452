"""What an adapter writes a standalone script of its engine with."""
