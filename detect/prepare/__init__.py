"""What several methods need of a record: its condition, filtered signals, cycles and half cycles."""
