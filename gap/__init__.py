"""The sim-to-real gap: where a model and a log part, which effect would explain it, and how far it shrinks then."""
