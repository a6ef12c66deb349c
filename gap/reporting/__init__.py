"""What a diagnosis says of an explanation: sizes, shrinkage, what the log cannot separate, the next test."""
