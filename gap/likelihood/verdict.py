"""How unusual what a hypothesis leaves is."""

from dataclasses import dataclass

ALARM = 0.005  # share of right hypotheses that are called wrong


@dataclass(frozen=True)
class Verdict:
    """How unusual innovations are: the largest figure, ``size`` [standard deviations], its ``name``, and its chance
    ``p`` if the hypothesis is right; ``limit`` which figures of right ones exceed with a chance of ``ALARM``.
    """

    size: float
    name: str
    p: float
    limit: float

    @property
    def unusual(self) -> bool:
        """Whether a right hypothesis leaves as much hardly ever."""
        return self.size > self.limit
