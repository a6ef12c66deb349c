"""A record made ready for several methods: its condition, filtered signals, cycles and half cycles."""
