"""What run.json, fit.json and a validation say, as frozen types; JSON is read and written here."""
