"""A figure that a notebook shows by itself, without a magic command."""

from matplotlib.figure import Figure
from stickslip.logs.notebook import png


class Picture(Figure):
    """The picture that every ``.plot()`` returns: a matplotlib figure, with its image for a notebook."""

    def _repr_png_(self) -> bytes:
        return png(self)
