"""A second opinion on every run: other people's solvers, and no code shared with the engine."""

from diagram.reference.integration import simulate_reference

__all__ = ["simulate_reference"]
