"""Which effects these signals cannot separate, whatever the gap: their traces agree up to a factor.

    cos(J_a, J_b) > SAME        J the slopes of the innovations at neutral, all signals and rows together

Small sizes of such effects leave the same log; which tag would tell them apart is in ``separating``.
"""

from collections.abc import Sequence

import numpy as np
from stickslip.gap.fits.search import Candidate
from stickslip.gap.fits.sensitivity import trace

SAME = 0.9998  # cosine from which on two traces are one


def classes(legal: Sequence[Candidate]) -> tuple[tuple[Candidate, ...], ...]:
    """Return groups of two or more effects that leave the same trace in the record."""
    units = []
    for candidate in legal:
        if candidate.effect is None or candidate.noisy or candidate.effect.hidden or not candidate.sizes:
            continue
        J, felt = trace(candidate)
        if candidate.sizes[0] in felt:
            column = np.nan_to_num(J[:, felt.index(candidate.sizes[0])])
            units.append((candidate, column / np.linalg.norm(column)))
    groups: list[list[int]] = []
    for k, (_, one) in enumerate(units):
        near = next((g for g in groups if abs(float(units[g[0]][1] @ one)) > SAME), None)
        if near is None:
            groups.append([k])
        else:
            near.append(k)
    return tuple(tuple(units[k][0] for k in group) for group in groups if len(group) > 1)
