"""The Kalman noise prefilter wired into a diagram.

    in   PV     noisy measurement [any unit]
    out  PV_f   filtered measurement, NaN before the first good sample
         noise  standard deviation of the measurement noise that the filter works with [unit of PV]

Every ``dt`` seconds one sample is taken.  Noise and liveliness are estimated from the last ``window`` samples,
once the window is full and again each time it has been renewed; a window that is half bad or at rest changes
nothing.  Until the first estimate, and always if ``window`` is 0, the filter uses ``noise_std`` and ``q`` as
given.  Under python-control it takes its samples at the solver's own steps (``stickslip.blocks.seen_samples``);
linearised, at its first sample, it is a wire.
"""

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from stickslip.blocks import Block, Kernels, Labels, Port
from stickslip.blocks.ports import require
from stickslip.blocks.role import Role
from stickslip.detect.signals import prefilter


class PrefilterState(NamedTuple):
    """Kalman state, the parameters in use, and the samples of the present window."""

    kalman: prefilter.State
    params: prefilter.Params
    t: tuple[float, ...]
    z: tuple[float, ...]


@dataclass(frozen=True)
class PrefilterHost:
    """Runs ``stickslip.detect.signals.prefilter`` and renews its parameters from the data, unless ``window`` is 0."""

    first: prefilter.Params
    window: int

    def init(self, p: NDArray[np.float64]) -> PrefilterState:
        """Return the state before the first sample."""
        return PrefilterState(prefilter.init(self.first), self.first, (), ())

    def step(
        self, t: float, state: PrefilterState, u: NDArray[np.float64], p: NDArray[np.float64]
    ) -> tuple[PrefilterState, list[float]]:
        """Take one sample; return the next state and (filtered value, noise)."""
        params, times, values = state.params, (*state.t, t), (*state.z, float(u[0]))
        if self.window and len(times) >= self.window:
            params = self._estimate(np.array(times), np.array(values), params)
            times, values = (), ()
        elif not self.window:
            times, values = (), ()
        kalman = prefilter.update(params, state.kalman, t, float(u[0]))
        seen = not np.isnan(kalman.t)
        return PrefilterState(kalman, params, times, values), [float(kalman.x[0]) if seen else np.nan, params.noise_std]

    def _estimate(self, t: NDArray[np.float64], z: NDArray[np.float64], present: prefilter.Params) -> prefilter.Params:
        """Return new parameters, or the present ones if the window holds nothing to learn from."""
        good = z[np.isfinite(z)]
        if len(good) < len(z) // 2 or np.ptp(good) <= 1e-12 * np.abs(good).max():
            return present
        return prefilter.estimate(t, z)


class PrefilterBlock(Block):
    """The noise prefilter, sampled every ``dt`` [s]; see the module docstring.

    Parameters: ``noise_std`` [unit of PV] and ``q`` [unit^2/s^3] to begin with, ``window`` samples per estimate
    (0: never estimate).  Raises ``BlockError`` if ``dt`` is not positive or the window shorter than 32.

    >>> from stickslip.detect.blocks import PrefilterBlock
    >>> PrefilterBlock(dt=1.0, noise_std=0.01, q=1e-6, inputs="PV_m").output_labels
    ['PV_f', 'noise']
    """

    role = Role.FILTER
    ports_in = (Port("PV"),)
    ports_out = (Port("PV_f"), Port("noise"))
    kernels = Kernels()
    period_param = "dt"

    def __init__(
        self, dt: float, *, noise_std: float = 0.01, q: float = 1e-6, window: int = 256, name: str = "prefilter",
        inputs: Labels = None, outputs: Labels = None,
    ) -> None:  # fmt: skip
        require(
            window == 0 or window >= 32, name, "window", window, "too few samples to estimate noise", "give 0 or >= 32"
        )
        self.host = PrefilterHost(prefilter.Params(noise_std, q), window)
        super().__init__(name=name, params={"dt": dt}, start_output=[np.nan, noise_std], inputs=inputs, outputs=outputs)

    @staticmethod
    def check(params: Any, name: str) -> None:
        """Refuse a sampling period that is not positive."""
        require(params["dt"] > 0.0, name, "dt", params["dt"], "a sampling period must be positive", "give seconds")
