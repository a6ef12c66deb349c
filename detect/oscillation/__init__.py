"""Oscillation detectors: modules with ``find(record) -> Gate``."""
