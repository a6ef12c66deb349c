"""The picture of a bicoherence: the squared bicoherence, NLI among its linear twins, and the PV-OP curve."""

from stickslip.detect.figures.verdict import finish
from stickslip.detect.verdict import FigureBase, Verdict
from stickslip.logs.style import INK, SOFT


def draw_bicoherence(v: Verdict, figure: FigureBase) -> None:
    """Draw bic^2 over both frequencies, NLI among its twins, and the PV-OP curve where it was measured."""
    left, middle, right = figure.subplots(1, 3, width_ratios=(5, 3, 4))
    points = left.scatter(v.array("f1"), v.array("f2"), c=v.array("squared"), s=14, marker="s", cmap="viridis", vmin=0)
    figure.colorbar(points, ax=left, label="bic² [-]")
    middle.hist(v.array("twins"), bins=12, color=SOFT, alpha=0.6)
    assert v.index is not None
    middle.axvline(v.index, color=INK)
    if len(v.array("op")):
        right.plot(v.array("op"), v.array("pv"), color=INK, lw=0.8)
        width = float(v.array("width")[0])
        right.plot([-width / 2, width / 2], [0, 0], color=SOFT, lw=2.5)
    finish(left, "f1 [cycles / sample]", "f2 [cycles / sample]")
    finish(middle, "NLI: linear twins, and the record (line)", "twins")
    finish(right, "OP, coupled frequencies", "PV, coupled frequencies")
