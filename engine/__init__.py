"""The compiled simulator: arrays and kernel addresses, no names."""
