"""What a diagnosis returns: the report, its picture, its evidence and its probability."""
