"""Loops of a simulator written apart, that nothing is learnt from: what the verdict is worth away from home."""
