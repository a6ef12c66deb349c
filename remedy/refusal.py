"""What the fit of a loop refuses at once; commands ask before they load the fit, which takes seconds."""

__all__ = ["STANDS", "FitError", "refuse_short"]

FEWEST = 200  # samples
STANDS = "OP or PV stands still all along; log a stretch in automatic in which both move"


class FitError(ValueError):
    """A record to which no loop can be fitted; the message says why, and what would help."""


def refuse_short(samples: int) -> None:
    """Raise ``FitError`` for a record of fewer ``samples`` [-] on an even grid than a fit needs."""
    if samples < FEWEST:
        raise FitError(
            f"the record has {samples} samples on an even grid; {FEWEST} are needed, a few hours at the scan are good"
        )
