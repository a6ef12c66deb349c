"""The same diagrams solved by scipy or CVODE, to check the engine: slow, and without code shared with it."""

from stickslip.diagram.reference.integration import simulate_reference

__all__ = ["simulate_reference"]
