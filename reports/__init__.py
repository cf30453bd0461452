"""Reports of runs, fits, validations and characterizations, as HTML, PDF, Markdown and pictures."""
