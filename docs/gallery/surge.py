"""
Surge on the map
================

A compressor of one's own map, with and without anti-surge control.
"""

from stickslip.cases import find
from stickslip.cases.topologies.map_plane import map_plane

map_plane(find("own_map").run())
