"""All explanations of a gap side by side: one effect, two effects, none but an unmeasured load."""
