"""One folder a scenario: ``<name>.yaml``, ``reference.py`` (the truth) and ``README.md``."""
