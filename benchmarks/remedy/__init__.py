"""Fits and remedies on hidden plants: ``python -m benchmarks.remedy``."""
