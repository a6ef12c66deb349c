"""The compiled simulator: arrays and kernel addresses, no names."""

from engine import place

place.choose()
