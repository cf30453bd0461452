"""Programs and devices whose logs say no units: one YAML file each, with its evidence."""
