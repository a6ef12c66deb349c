"""The second look: an accusation of which the calibrated model is not sure stands only if simulation bears it out."""

from dataclasses import replace

from calibration.by_simulation import AtRecord, together
from detect.chances import chance
from detect.diagnosis import Diagnosis
from detect.judge.model import calibrated

__all__ = ["second_look"]


def second_look(diagnosis: Diagnosis, found: AtRecord) -> Diagnosis:
    """Return the diagnosis, left open where it is stiction and simulation does not bear that out.

    Parameters: ``diagnosis`` of a record, and what was ``found`` by simulation under the record's own conditions.

    The mean log odds of both have to reach the limit from which on the calibrated model calls stiction.  Only an
    accusation of which the model is not sure (``Diagnosis.unsure``) is taken back; none is made.
    """
    if diagnosis.probability is None or diagnosis.verdict != "stiction" or not diagnosis.unsure:
        return diagnosis
    both, limit = together(diagnosis.probability, found.probability), calibrated().accuse
    if both >= limit:
        return diagnosis
    reason = (
        f"The record leaves it open: the calibrated model gives stiction {chance(diagnosis.probability)}, but of loops "
        f"simulated under the conditions of this record those most like it give {chance(found.probability)}. Together "
        f"that makes {chance(both)}, and stiction is called from {100.0 * limit:.0f} % on."
    )
    return replace(diagnosis, verdict="inconclusive", amount=None, reason=reason)
