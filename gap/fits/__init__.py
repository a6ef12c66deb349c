"""Fits of an effect to a record, by its kind, and whether a fit is good enough to be named."""
