"""Faults of a record, checked before anything is judged.  Each file has one, with its number, limit and remedy."""
