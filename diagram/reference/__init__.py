"""The same diagrams solved by scipy or CVODE: slow, and without code shared with the engine, which it serves to check."""

from diagram.reference.integration import simulate_reference

__all__ = ["simulate_reference"]
