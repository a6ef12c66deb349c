"""The display of results: one line as ``repr``, and in a notebook that line with the picture."""

from textwrap import shorten
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["Shown"]

LINE_CHARACTERS = 240  # characters of a repr at most


class Shown:
    """Base of a result with a ``headline`` and a ``plot()``.

    >>> class Answer(Shown):
    ...     headline = "stiction in FIC101"
    >>> Answer()
    <Answer: stiction in FIC101>
    """

    @property
    def headline(self) -> str:
        """The result in one sentence."""
        raise NotImplementedError

    def plot(self) -> "Figure":
        """Draw the result."""
        raise NotImplementedError

    def __repr__(self) -> str:
        return f"<{type(self).__name__}: {shorten(self.headline, LINE_CHARACTERS, placeholder=' ...')}>"

    def _repr_html_(self) -> str:
        from stickslip.logs.notebook import image, paragraph

        return paragraph(repr(self)) + image(self.plot())
