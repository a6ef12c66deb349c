"""Checks of what a user states of a finished block: role, tolerances, start values, outputs held."""

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from stickslip.blocks.control_view import ControlView
from stickslip.blocks.declared import PARTS
from stickslip.blocks.kernels import Floats
from stickslip.blocks.ports import BlockError, Port, nearest, number, require
from stickslip.blocks.role import Role


def check_role(block: ControlView, role: str, plays: Mapping[str, str]) -> None:
    """Raise ``BlockError`` for a role that is none of ``Role``, a part that is none, or a port that is not there."""
    roles = [str(known) for known in Role]
    if role not in roles:
        raise BlockError(f"{block.name}: role = {role!r} is none; {nearest(role, roles)}")
    ports = [port.name for port in (*block.ports_in, *block.ports_out)]
    for part, port in plays.items():
        if part not in PARTS:
            raise BlockError(f"{block.name}: '{part}' is no part in a loop; {nearest(part, PARTS)}")
        if port not in ports:
            raise BlockError(f"block '{block.name}' has no port '{port}'; {nearest(port, ports)}")


def checked_span(name: str, key: str, span: Any, units: Mapping[str, str]) -> tuple[float, float]:
    """Return low and high end of an instrument's span, refusing what is none; ``units`` of the ports that there are."""
    if key not in units:
        raise BlockError(f"block '{name}' has no port '{key}'; {nearest(key, list(units))}")
    ends = [number(name, f"span of {key}", end) for end in np.ravel(span).tolist()]
    rule = len(ends) == 2 and ends[0] < ends[1]
    require(rule, name, f"span of {key}", span, "it is a low and a higher end", "give e.g. (0.0, 1.0)")
    return ends[0], ends[1]


def checked_tolerances(block: ControlView, shares: Mapping[str, float]) -> dict[str, float]:
    """Return tolerances of parameters [share of the value]; raise ``BlockError`` for those that cannot be."""
    given = {key: number(block.name, f"tolerance of {key}", share) for key, share in shares.items()}
    for key, share in given.items():
        value = float(block.p[block.param_index(key)])
        rule = "a tolerance is a share of the value, from 0 to below 1"
        require(0.0 <= share < 1.0, block.name, f"tolerance of {key}", share, rule, "give 0.05 for 5 %")
        known = value != 0.0 and math.isfinite(value)
        remedy = "give tolerances to other parameters"
        require(known or share == 0.0, block.name, key, value, "it has no share", remedy)
    return given


def start_values(block: ControlView, values: Mapping[str, float]) -> tuple[Floats, Floats]:
    """Return the start values of all states and memories with some of them changed; see ``Block.starting_at``."""
    if block.modes and "mode" in values and values["mode"] not in block.modes.values():
        modes = ", ".join(f"{value:g} ({name})" for name, value in block.modes.items())
        raise BlockError(f"{block.name}: mode = {values['mode']!r}, but the modes are {modes}; give one of them")
    states, memory = block.x0.copy(), block.d0.copy()
    for key, value in values.items():
        if key in block.state_names:
            states[block.state_names.index(key)] = number(block.name, key, value)
        elif key in block.memory_names:
            memory[block.memory_names.index(key)] = number(block.name, key, value)
        else:
            known = [*block.state_names, *block.memory_names]
            raise BlockError(f"block '{block.name}' has no state '{key}'; {nearest(key, known)}")
    return states, memory


def one_each(given: ArrayLike, ports: Sequence[Port], name: str) -> Floats:
    """Return outputs that a block holds, (ports,); raise ``BlockError`` unless there is one number for each port."""
    outputs = np.array([number(name, "output held", value) for value in np.ravel(given).tolist()])
    rule = f"the block has {len(ports)} outputs"
    require(len(outputs) == len(ports), name, "start_output", outputs.tolist(), rule, "give one value per output")
    return outputs
