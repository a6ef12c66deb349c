"""A diagnosis calibrated on runs of the user's own model with known effects."""
