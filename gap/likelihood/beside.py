"""An effect that is not enough alone becomes part of the model, its sizes free: a second one is the same search again.

A stem is never part of the model, since each bank of stems has one that sticks.  Of a stem that is not enough alone the
likeliest path is: what is found beside that path becomes the part beside which stems are looked for again.
"""

from dataclasses import replace

from stickslip.gap.likelihood.few_stems import known_stem
from stickslip.gap.likelihood.fit import Fit, tried, unfitted
from stickslip.gap.likelihood.frame import Frame
from stickslip.gap.likelihood.hypothesis import Hypothesis


def with_effect(first: Fit) -> Frame:
    """Return what hypotheses share if a fitted effect, or the path of a fitted stem, is part of the model."""
    one, f, values = first.hypothesis, first.hypothesis.frame, first.best.values
    if one.hides:
        one, values = known_stem(first.best), {}
    assert one.effect is not None
    own = {name: values[name] for name in one.own}
    return replace(f, given=f.given.with_part(one.changed, one.effect, one.place, own, True), apart=False)


def as_part(found: Fit, stem: Fit) -> Fit | None:
    """Return an effect that was found beside the path of a stem as one that is part of the model without a stem."""
    one = replace(found.hypothesis, frame=stem.hypothesis.frame)
    known = {key: found.best.values[key] for key in (*one.own, *one.frame.free)}
    start = tried(Hypothesis(one.frame, one.effect, one.place), known)
    return None if start is None else unfitted(start)
