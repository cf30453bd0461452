"""Tasks that are learnt in a scenario: environments, policies and how well they do."""
