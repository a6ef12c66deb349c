"""What a model and a log bring to a diagnosis: signals, rounding, rows, nuisances, where the model starts."""
