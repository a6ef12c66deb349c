"""From the verdicts of many methods to one answer: how they are combined, and what to do next."""
