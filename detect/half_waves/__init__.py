"""Half waves and half cycles: where a wave crosses zero, where it peaks, its areas, and shapes fitted to it."""
