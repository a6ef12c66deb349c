"""Sensor: what the control system sees of a process variable.

Continuous (``Sensor``):
    tau dx/dt = factor PV + bias + drift t - x            (tau = 0: x follows at once)
    PV_m      = x limited to low ... high
Sampled every dt (``SampledSensor``):
    x_k    = the same lag, exact for a signal that is a straight line between samples
    PV_m,k = round((x_k + noise_k) / step) step, limited to low ... high      (step = 0: not rounded)
    noise_k: standard deviation sd, white or of correlation time T_c, see noise

in   PV  process variable            out  PV_m  measured process variable (same unit)
tau  lag [s]   factor  span factor [-]   bias [unit of PV]   drift [unit of PV / s]   low, high, sd, step [unit of PV]

Before its first sample a ``SampledSensor`` takes the signal for a straight line, too, from ``start`` on: where PV
stands elsewhere at that sample, it has been on its way for one ``dt``.

Source: the usual textbook elements; the line between samples is the first-order hold of Astrom and Wittenmark,
Computer-Controlled Systems, 3rd ed. 1997.  Valid for sensors slower than their own dynamics of higher order; not for
detection limits with hysteresis.  The compression of a historian is not a sensor effect: it acts on the log only.
See also: noise, arithmetic.
"""

import math
from collections.abc import Mapping
from typing import Any, Self

from stickslip.blocks.block import Block, Kernels
from stickslip.blocks.limits import FREE, MODES, limit_events, limit_transition
from stickslip.blocks.noise import Seed, Seeded, check_noise, coloured
from stickslip.blocks.ports import Labels, Port, require
from stickslip.blocks.role import Role
from stickslip.blocks.rules import check_limits, check_scan, finite

RESOLUTION = 2.0**52  # values of more steps than this are whole numbers of steps anyway

# p = tau, factor, bias, drift, low, high


def _target(t: float, u: Any, p: Any) -> float:
    """Return what the sensor would show at rest."""
    target: float = p[1] * u[0] + p[2] + p[3] * t
    return target


def _direct_out(t: float, x: Any, d: Any, u: Any, p: Any, y: Any) -> None:
    value = x[0] if p[0] > 0.0 else _target(t, u, p)
    y[0] = min(max(value, p[4]), p[5])


def _lagged_out(t: float, x: Any, d: Any, u: Any, p: Any, y: Any) -> None:
    y[0] = min(max(x[0], p[4]), p[5])


def _der(t: float, x: Any, d: Any, u: Any, p: Any, dx: Any) -> None:
    dx[0] = (_target(t, u, p) - x[0]) / p[0] if p[0] > 0.0 else 0.0


def _zc(t: float, x: Any, d: Any, u: Any, p: Any, g: Any) -> None:
    value = x[0] if p[0] > 0.0 else _target(t, u, p)
    limit_events(value, p[4], p[5], d, g)


# sampled: p = the same, then dt, offset, sd, correlation_time, step; d = generator and noise (7), x
# x = where the lag will be seen from at the next sample: x_k = x + b (target - x) whatever the lag's history was


def _step(t: float, x: Any, d: Any, u: Any, p: Any, y: Any) -> None:
    target = _target(t, u, p)
    periods = p[6] / p[0] if p[0] > 0.0 else math.inf
    seen = d[7] + (1.0 + math.expm1(-periods) / periods) * (target - d[7])
    d[7] = target + (periods / math.expm1(periods) if periods < 700.0 else 0.0) * (seen - target)
    value = seen + p[8] * coloured(d, 0, p[6], p[9])
    if p[10] > 0.0 and abs(value) < RESOLUTION * p[10]:
        value = p[10] * math.floor(value / p[10] + 0.5)
    y[0] = min(max(value, p[4]), p[5])


def _check(params: Mapping[str, float], name: str) -> None:
    finite(params, name, "tau", "factor", "bias", "drift")
    tau = float(params["tau"])
    require(tau >= 0.0, name, "tau", tau, "a lag is not negative", "give seconds, or 0 for none")
    check_limits(params, name)


def _span(low: float, high: float, spans: Mapping[str, tuple[float, float]] | None) -> dict[str, tuple[float, float]]:
    limits = {"PV_m": (float(low), float(high))} if math.isfinite(low) and math.isfinite(high) else {}
    return limits | dict(spans or {})


class Sensor(Block):
    """A continuous sensor: lag ``tau`` [s], span ``factor``, ``bias``, ``drift`` per second, limits.

    ``start``: the PV [unit of PV] at which the lag starts settled.  A sensor built with tau > 0 breaks algebraic
    loops, so its tau cannot be set to 0 later; build it with tau = 0 to vary tau from there.

    Raises ``BlockError`` for tau < 0, low >= high, or a value that is not finite.

    >>> sensor = Sensor(factor=1.1, bias=0.5, high=5.0)
    >>> [round(float(sensor.output(0.0, sensor.x0, [PV])[0]), 6) for PV in (0.0, 1.0, 9.0)]
    [0.5, 1.6, 5.0]
    """

    role = Role.SENSOR
    ports_in = (Port("PV"),)
    ports_out = (Port("PV_m"),)
    modes = MODES
    limit_params = ("low", "high")
    lag_param = "tau"

    def __init__(
        self, tau: float = 0.0, bias: float = 0.0, factor: float = 1.0, low: float = -math.inf, high: float = math.inf,
        *, drift: float = 0.0, start: float = 0.0, name: str = "sensor", inputs: Labels = None, outputs: Labels = None,
        units: Mapping[str, str] | None = None, spans: Mapping[str, tuple[float, float]] | None = None,
    ) -> None:  # fmt: skip
        self.kernels = Kernels(
            out=_lagged_out if tau > 0.0 else _direct_out, der=_der, zc=_zc, jump=limit_transition, n_events=2,
            feeds=not tau > 0.0, timed=True, linear=True,
        )  # fmt: skip
        super().__init__(
            name=name,
            params={"tau": tau, "factor": factor, "bias": bias, "drift": drift, "low": low, "high": high},
            states={"x": factor * start + bias},
            memory={"mode": FREE},
            inputs=inputs,
            outputs=outputs,
            units=units,
            spans=_span(low, high, spans),
        )

    @staticmethod
    def check(params: Mapping[str, float], name: str) -> None:
        """Raise ``BlockError`` unless tau >= 0, low < high and the rest is finite."""
        _check(params, name)

    def with_params(self, **changes: float) -> Self:
        """Return a copy with other parameter values (``tau`` = 0 only if built with tau = 0).

        Raises ``BlockError`` for a tau <= 0 of a sensor built with a lag, and as ``Sensor`` does.
        """
        if not self.kernels.feeds and "tau" in changes:
            tau = changes["tau"]
            require(tau > 0.0, self.name, "tau", tau, "this sensor was built with a lag", "build it with tau=0.0")
        return super().with_params(**changes)


class SampledSensor(Seeded):
    """A sensor read every ``dt`` [s]: what ``Sensor`` does, then noise, quantisation and limits.

    ``sd`` and ``correlation_time`` [s] describe the noise, ``step`` the quantisation, ``seed`` the random stream
    (by default it follows from the block's name; ``reseeded`` gives another).  Between samples PV_m is held.

    ``start``: the PV at which the lag starts settled [unit of PV]; ``offset``: first sample [s].
    Raises ``BlockError`` for dt <= 0, a negative tau, sd, correlation_time or step, or low >= high.

    >>> sensor = SampledSensor(dt=1.0, step=0.25, high=2.0)
    >>> [float(sensor.output(0.0, sensor.d0, [PV])[0]) for PV in (0.3, 0.4, 9.0)]
    [0.25, 0.5, 2.0]
    """

    role = Role.SENSOR
    ports_in = (Port("PV"),)
    ports_out = (Port("PV_m"),)
    kernels = Kernels(step=_step)
    period_param = "dt"
    limit_params = ("low", "high")
    lag_param = "tau"
    offset_param = "offset"

    def __init__(
        self, dt: float, *, sd: float = 0.0, correlation_time: float = 0.0, step: float = 0.0, tau: float = 0.0,
        bias: float = 0.0, factor: float = 1.0, low: float = -math.inf, high: float = math.inf, drift: float = 0.0,
        start: float = 0.0, offset: float = 0.0, seed: Seed | None = None, name: str = "sensor", inputs: Labels = None,
        outputs: Labels = None, units: Mapping[str, str] | None = None,
        spans: Mapping[str, tuple[float, float]] | None = None,
    ) -> None:  # fmt: skip
        lag = {"tau": tau, "factor": factor, "bias": bias, "drift": drift, "low": low, "high": high}
        at_rest = factor * start + bias
        super().__init__(
            name=name,
            params=lag | {"dt": dt, "offset": offset, "sd": sd, "correlation_time": correlation_time, "step": step},
            seed=seed,
            memory={"x": at_rest},
            start_output=[min(max(at_rest, low), high)],
            inputs=inputs,
            outputs=outputs,
            units=units,
            spans=_span(low, high, spans),
        )

    @staticmethod
    def check(params: Mapping[str, float], name: str) -> None:
        """Raise ``BlockError`` as ``Sensor`` does, and unless dt > 0 and sd, correlation_time, step >= 0."""
        _check(params, name)
        check_scan(params, name)
        check_noise(params, name)
        step = float(params["step"])
        rule = step >= 0.0 and math.isfinite(step)
        require(rule, name, "step", step, "a quantisation step is not negative", "give 0 for none")

    def smooth(self) -> Sensor:
        """Return the continuous sensor without noise and quantisation, which python-control sees in a diagram."""
        values = dict(zip(self.param_names, self.p, strict=True))
        return Sensor(
            **{key: float(values[key]) for key in ("tau", "bias", "factor", "low", "high", "drift")},
            name=self.name,
            inputs=self.input_labels,
            outputs=self.output_labels,
            units=self.units,
            spans=self.spans,
        ).starting_at(x=float(self.d0[7]))
