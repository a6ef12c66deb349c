"""Two effects, each fitted in the presence of the other."""

from dataclasses import dataclass

from stickslip.gap.explanations.candidates import PRICE
from stickslip.gap.fits.search import Fit


@dataclass(frozen=True, eq=False)
class Pair:
    """Two effects, each fitted in the presence of the other; the score is that of the second."""

    first: Fit
    second: Fit

    @property
    def total(self) -> float:
        """Score plus penalty, in log likelihood."""
        return self.second.F + self.first.price + self.second.price + PRICE

    @property
    def sticks(self) -> bool:
        """Whether one of the two has a hidden mode."""
        return self.first.effect.hidden or self.second.effect.hidden
