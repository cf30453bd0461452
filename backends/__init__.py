"""One file an engine: ``<engine>_.py`` with a ``BACKEND`` object; ``conformance`` is their contract."""
