"""Loops wired differently: a cascade, a split range, a compressor of the user's own map.

Each file is an example to copy: a function that builds the diagram, and the numbers that theory predicts for it.
"""

from stickslip.cases.topologies import cascade_flow, own_map, split_range

CASES = (cascade_flow.CASE, split_range.CASE, own_map.CASE, own_map.PLANT)
CASES_BY_NAME = {case.name: case for case in CASES}
