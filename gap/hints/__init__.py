"""What people get wrong when they bring a model and a log, said beside "unknown"."""
