"""What a model leaves of a record without a gap, and the problem that every explanation is measured by."""
