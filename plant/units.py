"""Which blocks of the production plant stand together: its units, for a drawing that fits a page."""

from stickslip.diagram.wired import Wired

__all__ = ["UNITS", "units"]

UNITS = {
    "feed": ("F_in", "Z_I"),
    "separator 1": (
        "S1", "SP_LCS11", "LCS11", "VLCS1", "VLCS1_body", "SP_PCS11", "PCS11", "VPCS1", "VPCS1_body", "scrubber_1",
        "m_G1", "SP_PCS12", "PCS12",
    ),
    "separator 2": (
        "S2", "SP_LCS21", "LCS21", "VLCS2", "VLCS2_body", "SP_PCS21", "PCS21", "VPCS2", "VPCS2_body", "scrubber_2",
        "m_G2", "SP_PCS22", "PCS22", "p_atm",
    ),
    "compressor 3": ("C3_inlet", "C3", "C3_outlet", "C3_pipe", "ASC3", "VRVC3", "VRVC3_body", "m_C4"),
    "compressor 2": ("C2_inlet", "C2", "C2_outlet", "C2_pipe", "ASC2", "VRVC2", "VRVC2_body", "p_C1"),
    "shaft and speed control": ("SP_VPCS2", "SC002", "SC001", "turbine", "shaft"),
}  # fmt: skip


def units(diagram: Wired) -> dict[str, tuple[str, ...]]:
    """Return the units of a plant or of a part of it, unit -> names of its blocks; {} for another diagram.

    >>> from stickslip.plant import production_plant
    >>> list(units(production_plant()))
    ['feed', 'separator 1', 'separator 2', 'compressor 3', 'compressor 2', 'shaft and speed control']
    """
    there = {block.name for block in diagram.blocks}
    found = {unit: tuple(name for name in names if name in there) for unit, names in UNITS.items()}
    return {unit: names for unit, names in found.items() if names} if {"S1", "S2", "C2", "C3"} & there else {}
