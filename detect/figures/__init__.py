"""Pictures of verdicts and diagnoses."""
