"""Pictures of diagrams, runs and ensembles."""
