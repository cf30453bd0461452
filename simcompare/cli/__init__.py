"""One small file a verb: it parses, calls the API and prints."""
