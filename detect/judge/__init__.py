"""One answer from the verdicts of many methods: how they are combined, and what to do next."""
