"""Loops wired differently: a cascade, a split range, a compressor of the user's own map.

Each page is an example to copy: a builder that reads like the diagram, and numbers that theory foretells.
"""

from cases.topologies import cascade_flow, own_map, split_range

CASES = (cascade_flow.CASE, split_range.CASE, own_map.CASE, own_map.PLANT)
CASES_BY_NAME = {case.name: case for case in CASES}
