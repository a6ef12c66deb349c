"""What a diagnosis says of an explanation: sizes, shrinkage, what cannot be told apart, the next test."""
