"""A diagram near its operating point, as a control engineer looks at it: transfer functions, poles, loops, RGA.

    dx/dt = A x + B v,   s = C x + D v          deviations; v is added to signals, s the signals that result

Any signal may be an input: what is added to it is seen by all that read it.  Adding to what a source gives (``F_in``,
``SP_PCS11``) is changing the source; adding to an OP is a disturbance of the valve.  Sticky stems are seen without
friction, since a stuck stem passes nothing on; where friction matters, look at the limit cycle instead.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import control as ct
import numpy as np
from stickslip.blocks.block import Block
from stickslip.blocks.ports import nearest
from stickslip.blocks.role import Role
from stickslip.diagram.diagram import Diagram
from stickslip.diagram.linear.gain_arrays import NEAR_ZERO, Complex, Rga, relative_gains
from stickslip.diagram.linear.loop import Loop
from stickslip.diagram.linear.operating_points import held, residual, sizes
from stickslip.diagram.linear.poles import Pole, poles_of
from stickslip.diagram.linear.slopes import Slopes, slopes
from stickslip.diagram.wiring import WiringError
from stickslip.logs.shown import Shown

if TYPE_CHECKING:
    from matplotlib.figure import Figure

REST = 1e-6  # largest rate, relative to each state's own, that still counts as rest


@dataclass(frozen=True, repr=False)
class Linear(Shown):
    """A linearised diagram; build one with ``linearise``.

    ``slopes`` block by block; ``at_rest`` whether the diagram rests there (else poles are those of a passing moment).
    """

    slopes: Slopes
    at_rest: bool

    @property
    def headline(self) -> str:
        """The result in one line."""
        where = "at rest" if self.at_rest else "not at rest"
        return f"{self.slopes.diagram.name}, {where}, {len(self.states)} states"

    @property
    def states(self) -> tuple[str, ...]:
        """Names of the states."""
        return self.slopes.states

    @cached_property
    def held(self) -> tuple[str, ...]:
        """States that nothing moves here: integrators of controllers at a limit."""
        return held(self.slopes)

    def system(
        self, inputs: str | Sequence[str], outputs: str | Sequence[str], cut: str | Sequence[str] = ()
    ) -> ct.StateSpace:
        """Return the state space from what is added to some signals to what others become, named.

        Of a signal in ``cut`` readers see only what is added, and its own output is only what its block gives.
        States that nothing moves, such as held ones, are left out.  Raises ``WiringError`` for a name that is no
        signal.

        >>> from stickslip.plant.loops import self_regulating_loop
        >>> G = linearise(self_regulating_loop()).system("SP", "PV")
        >>> G.input_labels, G.output_labels, round(float(G.dcgain()), 9)
        (['SP'], ['PV'], 1.0)
        """
        inputs, outputs, cut = _listed(inputs), _listed(outputs), _listed(cut)
        columns, rows = [self._place(name) for name in inputs], [self._place(name) for name in outputs]
        A, B, C, D = self.slopes.joined([self.slopes.signals[self._place(name)] for name in cut])
        moved = np.flatnonzero(np.hstack([A, B]).any(axis=1))  # the rest: poles at 0 that no dcgain() gets past
        return ct.ss(
            A[moved][:, moved], B[moved][:, columns], C[rows][:, moved], D[np.ix_(rows, columns)],
            inputs=inputs, outputs=outputs, states=[self.states[i] for i in moved],
            name=self.slopes.diagram.name, remove_useless_states=False,
        )  # fmt: skip

    # --- poles ----------------------------------------------------------------------------------------------
    @cached_property
    def poles(self) -> tuple[Pole, ...]:
        """Poles of the closed diagram from fast to slow, a complex pair as its upper one.

        >>> from stickslip.plant.loops import self_regulating_loop
        >>> [(round(pole.value.real, 3), pole.made_of()) for pole in linearise(self_regulating_loop()).poles[-2:]]
        [(-0.12, 'process[PV], controller[z]'), (-0.1, 'controller[z], process[PV]')]
        """
        real = np.array([name not in self.slopes.idle for name in self.states], dtype=bool)
        names = [name for name in self.states if name not in self.slopes.idle]
        A = self.slopes.joined()[0][np.ix_(real, real)]
        return poles_of(A, names, sizes(self.slopes)[0][real], self.held)

    @property
    def stable(self) -> bool:
        """Whether all poles but held ones lie in the left half plane."""
        return all(pole.value.real < 0.0 for pole in self.poles if not pole.held)

    # --- loops ----------------------------------------------------------------------------------------------
    @cached_property
    def controllers(self) -> tuple[str, ...]:
        """Names of the controllers that act here: not at a limit, their output passed on."""
        found = []
        for block in self.slopes.diagram.blocks:
            if measured(block) is not None and self._acts(block):
                found.append(block.name)
        return tuple(found)

    def loop(self, controller: str) -> Loop:
        """Return the loop of a controller, opened at its output, all others closed.

        Raises ``WiringError`` if there is no such controller, ``ValueError`` if it is at a limit.

        >>> from stickslip.plant.loops import self_regulating_loop
        >>> loop = linearise(self_regulating_loop()).loop("controller")  # L = 0.12/s, with a fast stem
        >>> round(loop.crossover, 4), round(loop.phase_margin, 1)
        (0.12, 89.9)
        """
        block, PV = self._controller(controller)
        OP = block.output_labels[0]
        return Loop(controller, PV, OP, -self.system(OP, OP, cut=[OP]))

    def rga(self, controllers: Sequence[str] | None = None, frequency: float = 0.0) -> Rga:
        """Return the relative gain array between OPs and PVs of ``controllers``, with their loops open.

        Default: all that act but the outer ones of cascades, whose OP is another's set point.  Other loops stay
        closed; ``frequency`` [rad/s].  At 0 it is the limit, finite for levels that integrate.
        Raises ``ValueError`` if the gains are singular, no controller is named, or the frequency is none.

        >>> from stickslip.plant.loops import self_regulating_loop
        >>> linearise(self_regulating_loop()).rga(["controller"]).values.real.round(9).tolist()
        [[1.0]]
        """
        names = tuple(self._inner() if controllers is None else controllers)
        if not names:
            raise ValueError("relative gains need a controller, but none is named or acts; name one")
        if not 0.0 <= frequency < np.inf:
            raise ValueError(f"frequency = {frequency!r} rad/s, but it is 0 (steady) or more; give rad/s")
        pairs = [self._controller(name) for name in names]
        OPs, PVs = [block.output_labels[0] for block, _ in pairs], [PV for _, PV in pairs]
        G = self.system(OPs, PVs, cut=OPs)
        if frequency > 0.0:
            values = relative_gains(_gain(G, 1j * frequency))
        else:
            moving = np.array([abs(pole.value) for pole in self.poles if not pole.held])
            s = NEAR_ZERO * float(moving.min(initial=1.0))
            values = 2.0 * relative_gains(_gain(G, 0.5 * s)) - relative_gains(_gain(G, s))
        return Rga(names, tuple(PVs), tuple(OPs), frequency, values)

    # --- pictures -------------------------------------------------------------------------------------------
    def plot(self) -> "Figure":
        """Return the poles over time constants, with the states they are made of."""
        from stickslip.diagram.linear.figures import plot_poles

        return plot_poles(self.poles, self.slopes.diagram.name)

    def bode(self, controllers: Sequence[str] | None = None) -> "Figure":
        """Return the Bode plots of the loops of ``controllers`` (default: all that act) in one picture.

        Raises ``ValueError`` if no controller is named and none acts.
        """
        from stickslip.diagram.linear.figures import plot_loops

        names = self.controllers if controllers is None else controllers
        if not names:
            raise ValueError("there is no loop to draw: no controller is named or acts; name one")
        return plot_loops([self.loop(name) for name in names])

    # --- names ----------------------------------------------------------------------------------------------
    def _place(self, signal: str) -> int:
        if signal not in self.slopes.signals:
            raise WiringError(f"the diagram has no signal '{signal}'; {nearest(signal, list(self.slopes.signals))}")
        return self.slopes.signals.index(signal)

    def _controller(self, name: str) -> tuple[Block, str]:
        block = self.slopes.diagram[name]
        PV = measured(block)
        if PV is None:
            known = [b.name for b in self.slopes.diagram.blocks if measured(b) is not None]
            raise WiringError(f"block '{name}' is no controller with SP and PV; {nearest(name, known)}")
        if not self._acts(block):
            OP = self.slopes.s[self._place(block.output_labels[0])]
            raise ValueError(f"controller '{name}' is at a limit here, OP = {OP:g}: its loop is open; leave it out")
        return block, PV

    def _inner(self) -> list[str]:
        """Return the controllers that act but those whose output is the set point of another."""
        set_points = set()
        for block in self.slopes.diagram.blocks:
            if measured(block) is not None:
                set_points.add(block.loop_signal("SP"))
        return [name for name in self.controllers if self.slopes.diagram[name].output_labels[0] not in set_points]

    def _acts(self, block: Block) -> bool:
        """Return whether a controller's output moves with what it measures."""
        signals = self.slopes.signals
        row = signals.index(block.output_labels[0])
        return bool(np.any(self.slopes.D[row] != 0.0))


def linearise(diagram: Diagram, t: float = 0.0, friction: bool = False) -> Linear:
    """Return ``diagram`` linearised where it starts, at time ``t`` of its sources [s].

    Take ``operating_point(...).diagram`` for a diagram at rest.  Sticky stems are seen without friction unless
    ``friction`` (then a stuck stem passes nothing on).  Blocks that sample are seen as their continuous twins, without
    the half period for which they hold on average, a FIR filter as its gain, a ``SampledFunction`` by its first sample.

    >>> from stickslip.diagram.linear import linearise
    >>> from stickslip.plant.loops import self_regulating_loop
    >>> linearise(self_regulating_loop()).stable
    True
    """
    seen = diagram if friction else diagram.with_blocks([block.without_friction() for block in diagram.blocks])
    found = slopes(seen, t)
    return Linear(found, residual(found) <= REST)


def open_loop(diagram: Diagram, controller: str, t: float = 0.0) -> Loop:
    """Return the loop of one controller; see ``Linear.loop``."""
    return linearise(diagram, t).loop(controller)


def rga(diagram: Diagram, controllers: Sequence[str] | None = None, frequency: float = 0.0, t: float = 0.0) -> Rga:
    """Return the relative gain array; see ``Linear.rga``."""
    return linearise(diagram, t).rga(controllers, frequency)


def measured(block: Block) -> str | None:
    """Return the signal a controller controls, or None if the block is no controller."""
    return block.loop_signal("PV") if block.role is Role.CONTROLLER and len(block.ports_out) == 1 else None


def _gain(G: ct.StateSpace, s: complex) -> Complex:
    return np.asarray(G(s, squeeze=False), dtype=complex).reshape(G.noutputs, G.ninputs)


def _listed(names: Any) -> list[str]:
    return [names] if isinstance(names, str) else list(names)
