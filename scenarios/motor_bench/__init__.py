"""A DC motor with an encoder, braked over a lever that presses on a scale."""
