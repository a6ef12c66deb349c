"""Published experiments as named cases, with published, analytic and reproduced numbers side by side.

>>> from stickslip.cases import find, names
>>> names()[:5]
('ideal_high', 'ideal_normal', 'ideal_half_gain', 'ideal_integrating', 'sine')
>>> names()[5:11]
('plant_1_none', 'plant_1_normal', 'plant_1_high', 'plant_2_none', 'plant_2_normal', 'plant_2_high')
>>> names()[11]
'plant_1_high_two_jumps'
>>> names()[12:16]
('cascade_flow', 'split_range', 'own_map', 'plant_own_map')
>>> names()[16:]
('ideal_flow', 'site_flow', 'second_order_flow', 'level_loop', 'level_cascade', 'cascaded_tanks',
 'separator_section', 'full_plant')
>>> find("sine").duration
600.0
"""

from stickslip.cases.case import Case, Number
from stickslip.logs.hint import nearest

__all__ = ["Case", "CaseError", "Number", "find", "names"]


class CaseError(ValueError):
    """There is no case of that name."""


def _all() -> dict[str, Case]:
    from stickslip.cases import ideal, models, plant_models, production, topologies

    return {
        **ideal.CASES_BY_NAME,
        **production.CASES_BY_NAME,
        **topologies.CASES_BY_NAME,
        **models.CASES_BY_NAME,
        **plant_models.CASES_BY_NAME,
    }


def names() -> tuple[str, ...]:
    """Return the names of all cases."""
    return tuple(_all())


def find(name: str) -> Case:
    """Return a case by name; raise ``CaseError`` with the nearest names if there is none."""
    known = _all()
    if name not in known:
        raise CaseError(f"there is no case '{name}'; {nearest(name, known)}")
    return known[name]
