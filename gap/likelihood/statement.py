"""What a hypothesis states, an effect at a place or none: a diagram, its parameters, and its exact filter if any."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from stickslip.diagram.diagram import Diagram
from stickslip.gap.exact.affine import NotAffine
from stickslip.gap.exact.exact import Exact
from stickslip.gap.insertion.effect import Effect
from stickslip.gap.insertion.paths import given
from stickslip.gap.insertion.scales import ends
from stickslip.gap.likelihood.frame import Frame
from stickslip.gap.records.model import nuisances, silenced, smoothed
from stickslip.logs.arrays import Values

BEYOND = 0.1  # of its range, by which a signal may go further between two rows


@dataclass(frozen=True, eq=False)
class Statement:
    """An ``effect`` at a ``place``, or none; ``level``: it leaves its signal the level that the model has somewhere."""

    frame: Frame
    effect: Effect | None = None
    place: str = ""
    level: bool = False

    def __str__(self) -> str:
        return "the model alone" if self.effect is None else f"{self.effect.name} at {self.place}"

    @cached_property
    def changed(self) -> Diagram:
        """The model with the blocks of the effect."""
        f = self.frame
        if self.effect is None or self.effect.of_log:
            return f.model
        return self.effect.started(self.effect.put(f.model, self.place), self.place, f.first)

    @property
    def sticks(self) -> bool:
        """Whether its effect has a mode, as a stem has that sticks."""
        return self.effect is not None and self.effect.hidden

    @property
    def hides(self) -> bool:
        """Whether its effect has a mode that no log shows; a replay follows it by the log itself."""
        return self.sticks and not self.frame.replays

    @property
    def bends(self) -> bool:
        """Whether its effect is a limit: gains of a model without it do not hold where it is met."""
        return self.own == ("low", "high")

    @property
    def nests(self) -> str:
        """The effect that its own is where its further sizes are neutral: a stem that does not jump."""
        return self.effect.nests if self.effect else ""

    @cached_property
    def own(self) -> tuple[str, ...]:
        """Parameters of the effect."""
        return tuple(p.name for p in self.effect.parameters) if self.effect else ()

    @cached_property
    def bounds(self) -> dict[str, tuple[float, float]]:
        """Parameter -> (low, high): those of the effect, then what is free in every fit."""
        own = dict(self.effect.bounds(self.frame.model, self.place)) if self.effect else {}
        spanned = [p for p in self.effect.parameters if p.per == "span"] if self.effect else []
        largest = self._unstated_span() if spanned else 0.0
        if largest > 1.0:
            own |= {p.name: (p.low * largest, p.high * largest) for p in spanned}
        shown, values, zero, to_unit = self.reached if self.bends else ("", np.zeros(0), 0.0, 1.0)
        if shown:  # a limit is where the log goes, whatever spans are stated
            reach = BEYOND * float(np.ptp(values))
            lowest, highest = (float((end - zero) * to_unit) for end in (values[0] - reach, values[-1] + reach))
            own = {name: (min(low, lowest), max(high, highest)) for name, (low, high) in own.items()}
        return own | self.frame.free

    def _unstated_span(self) -> float:
        """Return the largest value of a logged signal whose span no block states, 0 where one does: PV has any unit."""
        f, outputs = self.frame, self.frame.model[self.place].output_labels
        signal = str(outputs[0]) if outputs else ""
        if signal not in f.signals or ends(f.model, signal) is not None:
            return 0.0
        return float(np.max(np.abs(np.nan_to_num(f.Y[:, f.signals.index(signal)])), initial=0.0))

    @cached_property
    def reached(self) -> tuple[str, Values, float, float]:
        """The logged signal that shows a limit, its values in order, and what turns them into sizes of the effect: a
        zero to take away, and a factor.
        """
        f = self.frame
        assert self.effect is not None
        signals = [str(s) for s in f.model[self.place].output_labels + f.model[self.place].input_labels]
        shown = next((s for s in signals if s in f.signals), f.ops[-1] if f.ops else "")
        if not shown:
            return "", np.zeros(0), 0.0, 1.0
        low, high = f.model.signal_spans.get(shown, (0.0, 1.0))
        to_unit = 100.0 / (high - low) if self.effect.parameters[0].unit.startswith("%") else 1.0
        values = f.Y[:, f.signals.index(shown)]
        return shown, np.sort(values[np.isfinite(values)]), low if to_unit != 1.0 else 0.0, to_unit

    @cached_property
    def nominal(self) -> dict[str, float]:
        """Parameter -> its value without the effect."""
        own = self.effect.nominal(self.frame.model, self.place) if self.effect else {}
        return own | self.frame.stated

    def settings(self, values: Mapping[str, float]) -> dict[str, float]:
        """Return the parameters of blocks that these values stand for."""
        found = self.frame.given.settings(values)
        if self.effect is not None:
            own = {name: values[name] for name in self.own}
            found |= self.effect.settings(self.frame.model, self.place, **own)
        return found

    @cached_property
    def silent(self) -> Diagram:
        """The changed model without random numbers."""
        return silenced(self.changed)

    def model(self, values: Mapping[str, float]) -> Diagram:
        """Return the diagram, with its nuisances, that these values stand for."""
        grouped: dict[str, dict[str, float]] = {}
        for key, size in self.settings({**self.nominal, **values}).items():
            block, _, name = key.rpartition(".")
            grouped.setdefault(block, {})[name] = float(size)
        found = self.changed
        for block, own in grouped.items():
            found = found.replace(block, found[block].with_params(**own))
        return found

    @cached_property
    def exact(self) -> Exact | None:
        """Its Kalman filter, None where its diagram is not linear and scanned, as far as is known."""
        f = self.frame
        if f.scans is None or (self.effect is not None and (self.effect.of_log or self.hides)):
            return None
        changed = self.changed
        return Exact(smoothed(changed), nuisances(changed), f.signals, f.record, f.scans, f.unsure)

    @cached_property
    def bare(self) -> Exact | None:
        """The Kalman filter of the model without the effect, None where rows are not in step with its scans."""
        f = self.frame
        return None if f.scans is None else Exact(f.smooth, f.noise, f.signals, f.record, f.scans, f.unsure)

    @cached_property
    def cheap(self) -> bool:
        """Whether a bank of stems takes little time: in a loop that is linear else, whose controllers scan alike."""
        if self.bare is None:
            return False
        try:
            loop = self.bare.scanned(*self.stated_of(self.bare, self.nominal), cut=given(self.frame.model, self.place))
        except NotAffine:
            return False
        return not bool((loop.period > 1).any())

    @cached_property
    def drawing(self) -> frozenset[str]:
        """The sizes of all random numbers of the changed model, those that no logged signal feels as well."""
        return frozenset(f"{one.block}.{key}" for one in nuisances(self.changed) for key in ("sd", "correlation_time"))

    def stated_of(
        self, exact: Exact, values: Mapping[str, float]
    ) -> tuple[dict[str, float], dict[str, tuple[float, float]]]:
        """Return the parameters of an exact filter's blocks, and the sizes of its random numbers."""
        settings = self.settings(values)
        there = {b.name for b in exact.diagram.blocks}
        params = {k: v for k, v in settings.items() if k not in self.drawing and k.rpartition(".")[0] in there}
        sizes = {
            one.block: (
                math.hypot(settings.get(f"{one.block}.sd", one.sd), one.rounding),
                settings.get(f"{one.block}.correlation_time", one.correlation_time),
            )
            for one in exact.noise
        }
        return params, sizes
