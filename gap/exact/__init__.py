"""The exact filter of loops that are linear and scan in step with their log, and a bank of stems in such a loop."""
