"""How engines behave in small experiments with a known answer, over speeds, loads and steps."""
