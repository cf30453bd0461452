"""One file an engine, ``<engine>_.py`` with a ``BACKEND``; ``conformance`` is their contract."""
