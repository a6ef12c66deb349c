"""Plants that the house has never seen, in plain numpy from their equations, and how well the gap to a model is found."""
